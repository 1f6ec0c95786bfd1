// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

namespace palpate {

/// What the data say about one unknown modulus.
struct Verdict {
    std::string verdict;  ///< "recovered", "weak", "not identifiable", "not judged"
    std::string reason;   ///< one sentence
};

/// A modulus is *recovered* if its 95 % interval spans at most a factor of 2, *weak* if more, *not
/// identifiable* if the data narrow the prior by less than a third (method.md section 3).
///   sd_ln, prior_sd_ln  posterior and prior standard deviation of ln E
Verdict judge(const std::array<double, 2>& interval_kpa, double sd_ln, double prior_sd_ln);

/// For a region that no observed surface touches: its modulus has no influence on the data.
Verdict judge_unobserved(bool surface_is_driven);

/// For a model whose every modulus is unknown: only ratios of moduli can be found.
Verdict judge_without_reference();

/// For a search that computes no interval.
Verdict not_judged(const std::string& method);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "host/estimate/verdict.hpp"

namespace palpate {

/// What the data say about one unknown.
struct Judgement {
    Verdict verdict = Verdict::not_judged;
    std::string reason;  ///< one sentence
};

/// Of a modulus and whatever else is positive: an interval of at most this factor is *recovered*.
constexpr double recovered_factor = 2.0;
/// Data that leave more of the prior's standard deviation than this say nothing worth telling.
constexpr double unseen_share = 2.0 / 3.0;
/// Of an unknown on a scale of its own: data that leave at most this share have *recovered* it.
constexpr double recovered_share = 0.5;
/// Two unknowns that correlate more than this trade with each other.
constexpr double strong_correlation = 0.9;

/// What is known of one unknown after a search, on the scale on which its prior is Gaussian.
struct UnknownEvidence {
    double sd = 0, prior_sd = 1;  ///< posterior and prior; the prior's may be infinite
    double seen_sd = 0;  ///< from the data's information of the mean alone (posterior.hpp); 0: same
    /// Whether the data without the prior bound it.
    bool excludes_low = true, excludes_high = true;
};

/// Which case of the rules holds; words are the caller's.
enum class EvidenceCase { unseen, lower_bound_only, upper_bound_only, bounded };

/// *Unseen* if the data, or the part of them that is not a prior's, narrow the prior by less than a
/// third, or if they bound the unknown on neither side; else what they bound (method.md section 5).
EvidenceCase case_of(const UnknownEvidence& evidence);

/// *Recovered* if an interval that is bounded on both sides spans at most `recovered_factor`.
Verdict verdict_of_span(double span);
/// The verdict of an unknown on a scale of its own, of whose prior spread `share` is left.
Verdict verdict_of_share(double share);

/// 95 % of a Gaussian prior of ln: the median divided and multiplied by exp(1.96 sd).
std::array<double, 2> prior_interval(double median, double prior_sd_ln);

/// The interval to tell: the prior's if the unknown is not identifiable, else what was found, where
/// an end that the data do not give is at least the prior's.
std::array<double, 2> told_interval(const std::array<double, 2>& found,
                                    const std::array<double, 2>& prior,
                                    const UnknownEvidence& evidence, Verdict verdict);

}  // namespace palpate

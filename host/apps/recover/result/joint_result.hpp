// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// What several targets tell together.
struct JointResult {
    std::vector<RegionResult> regions;  ///< of unknown moduli: modulus, interval, verdict
    std::size_t num_targets = 0;        ///< that took part
    /// Targets that did not, and why: they tell nothing of their own.
    std::vector<std::pair<std::size_t, std::string>> left_out;
    double seconds = 0;
    std::string failure;  ///< why there is none; else empty
};

}  // namespace palpate

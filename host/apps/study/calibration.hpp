// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/apps/study/row.hpp"
#include "host/apps/study/tables.hpp"

namespace palpate {

/// How honest the intervals of one family of phantoms are: those that were loaded alike and whose
/// contours were drawn alike.
struct Calibration {
    std::string family;
    std::size_t count = 0;
    std::size_t num_holding = 0;          ///< 95 % intervals that hold the truth
    double median_abs_ln_error = 0;       ///< of ln E
    double bias_ln = 0;                   ///< mean error of ln E
    double error_over_claimed = 0;        ///< root mean square of error / claimed deviation
    std::array<double, 2> claim_range{};  ///< 95 % range of that: 1 is honest
    double narrowest_factor = 0;          ///< between the ends of the narrowest interval
};

/// By anatomy, by load, then by kind of contours, then of all; a grouping of one family only is
/// left out. `rows` have anatomy, load, contours, ln_error, claimed_sd, low_kpa, high_kpa and
/// holds_truth.
std::vector<Calibration> calibration_by_family(const std::vector<Row>& rows);

StudyTable calibration_table(const std::vector<Calibration>& families);

}  // namespace palpate

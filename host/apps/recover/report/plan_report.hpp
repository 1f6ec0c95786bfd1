// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/page/result_tree.hpp"

namespace palpate {

/// What a set of targets would tell of one modulus.
struct PlannedInterval {
    int fuller = 1;    ///< targets with walls moved outwards
    int emptier = 0;   ///< and as far the other way
    double sd_ln = 0;  ///< expected standard deviation of ln E, the model's error included
    bool is_identifiable = true;  ///< whether a result would be given, not the prior's interval
};

/// One organ, supposed to be as stiff as this.
struct PlanRow {
    std::string region;
    double supposed_kpa = 0;
    double moved_mm = 0;  ///< root mean square of its surface
    std::vector<PlannedInterval> intervals;
};

/// Upper over lower end of a 95 % interval.
double interval_factor(const PlannedInterval& interval);

/// For a terminal: a line for each row, a column for each set of targets. Ends with a newline.
std::string plan_table(const std::vector<PlanRow>& rows);

/// The same for programs, with what was supposed of the walls and of the contours.
ResultTree plan_tree(const std::vector<PlanRow>& rows, double motion_mm, double contour_mm);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/types.hpp"

/// The loops over all pixels of a column that every frame runs through, for the vector units.
/// Grey values, rows from the top; columns have room for `end` rows.
namespace palpate {

/// Columns [width][stride] of the first `end` rows [end][width] of a frame.
void turn_columns(const float* frame, Index width, Index end, Index stride, float* columns);

/// p[0] + p[1] row + p[2] row^2 away from the grey values, and sums of three rows of what is left:
/// of the first row and its neighbour with 1.5 times their weight; rows to end - 2.
void take_background(const float* grey, const float* p, Index end, float* residual, float* sum);

/// The mean of three columns of such sums.
void mean_of_nine(const float* left, const float* middle, const float* right, Index end,
                  float* mean);

/// How much rather a pixel is tissue than background, see `pixel_evidence`.
struct EvidenceScales {
    float sigma = 1;            ///< of the background
    float tissue = 1, sd = 1;   ///< mean and standard deviation of tissue
    float most = 1, least = 1;  ///< bounds of one pixel: for tissue, and against it
    float factor = 1;           ///< of all of it
};

/// For tissue, in units of costs:
///     e = min(d^2 / 2, 8) - min(t^2 / 2, 4) - ln(sd / sigma) / 2,
/// d, t in standard deviations from background and tissue, then bounded.
void pixel_evidence(const float* smooth, const EvidenceScales& scales, Index end, float* evidence);

/// cost[y] = sum of the evidence of rows before y, y from 0 to end.
void sum_before(const float* evidence, Index end, float* cost);

/// Rows that are added up on either side of a step.
inline constexpr Index step_rows = 5;

/// How much a step of brightness earns, in units of costs.
struct StepRewards {
    float per_step = 1, most_step = 1;    ///< of the difference of sums of five rows
    float per_slope = 1, most_slope = 1;  ///< of the derivative over seven rows
};

/// Takes away from the costs of an outline between rows y - 1 and y, y from 5 to end - 3, what the
/// step there earns. `sums` is room for end numbers; `residual` has end + 4 rows.
void reward_steps(const float* residual, const StepRewards& rewards, Index end, float* sums,
                  float* cost);

/// Adds weight min(|y - expected|, most) to the cost of y from 0 to end.
void add_jumps(float expected, float weight, float most, Index end, float* cost);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/apps/recover/inverse/linear_row.hpp"

namespace palpate {

/// The share of slices in the noise of contours that residuals show, 0 to 1. Products r_i r_j of
/// rows of one surface less than 12 mm apart are compared with slice_correlation among pairs of the
/// same distance, so that a kernel that is only shorter or longer than assumed shows none:
///   b = sum (p - <p>_d) (s - <s>_d) / sum (s - <s>_d)^2,   share = b / (a + b),
/// r less its linear trend on each surface, a the part of what is left that goes with
/// contour_correlation. Below a quarter it counts as none.
double slice_share_of(const std::vector<LinearRow>& rows, const Eigen::VectorXd& residual_mm);

}  // namespace palpate

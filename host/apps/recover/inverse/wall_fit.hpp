// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "host/apps/recover/inverse/linear_row.hpp"
#include "host/apps/recover/inverse/wall_prior.hpp"

namespace palpate {

/// How walls move, as their own distances show it.
struct WallMotionScale {
    struct Wall {
        double normal_mm = 0;  ///< standard deviation along the normal
        double range_mm = 0;
    };
    std::vector<Wall> walls;  ///< in the order of the prior's
    double tangential = 1;    ///< motion along walls over that along their normals, but for a least
                              ///< motion of 1.5 mm that is always possible
    double rigid_mm = 0;      ///< standard deviation of each wall's shift and turn as a body
};

/// What `prior` expects before it has seen a distance.
WallMotionScale expected_scale(const WallPrior& prior);

/// The scale of largest evidence: the density of the walls' distances alone, given `rows`
/// linearised at the driven displacement `driven` with their noise held, times log-normal priors
/// (method.md, 3.2) that are the same whatever `prior` expects: that is where the search starts,
/// and what is kept of walls without rows. With C the covariance of the distances of one wall,
///   -2 L = sum over walls of y^T C^-1 y + ln det C,   C_ij = n_i Cov(u_i, u_j) n_j + R_ij,
/// Cov as in WallPrior with c_ij = s^2 (1 + q) exp(-q), q = sqrt(3) d / range (Matern 3/2), and
/// rigid motions of the standard deviation that is expected, by
/// BOBYQA in logarithms (Powell 2009) on at most some hundred rows of each wall. Moduli do not
/// enter.
WallMotionScale fit_walls(const WallPrior& prior, const std::vector<LinearRow>& rows,
                          const Eigen::VectorXd& driven, const FramePrior& frame);

/// `prior` with the covariances that belong to `scale`.
std::shared_ptr<const WallPrior> walls_of(const WallPrior& prior, const WallMotionScale& scale);

}  // namespace palpate

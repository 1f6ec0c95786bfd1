// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "host/inverse/marginal.hpp"
#include "host/inverse/records.hpp"

namespace palpate {

/// Half the 95 % quantile of chi squared with one degree of freedom: F rises by this at the ends of
/// a 95 % profile interval.
constexpr double profile_rise = 1.920729;

/// Inverse of the curvature of F at its minimum; directions without curvature get the prior's
/// variance.
Eigen::MatrixXd laplace_covariance(const LinearisedProblem& problem, const Eigen::VectorXd& theta);

/// F along ln E_k, the other moduli following the ridge (conditional mean of the Laplace
/// posterior), over at least +-4 standard deviations.
ProfileResult profile_of(const LinearisedProblem& problem, const Eigen::VectorXd& theta,
                         const Eigen::MatrixXd& covariance, Index unknown);

/// Where the profile has risen by `profile_rise` on either side, kPa; the end of the profile where
/// it never does.
std::array<double, 2> profile_interval(const ProfileResult& profile, double best_kpa);

/// Standard deviation of ln E that the model itself adds: linear tetrahedra of the default size and
/// surfaces drawn from voxels. Set on 36 phantoms (truth on 30,000 nodes, both states voxelised at
/// 1 mm, seeds 101 to 112 and 201 to 224) so that 94 % of the 95 % intervals hold the truth;
/// checked on others by `palpate study coverage`.
constexpr double model_sd_ln = 0.07;

/// The interval with the model's own uncertainty added in quadrature on either side of ln E.
std::array<double, 2> with_model_error(const std::array<double, 2>& interval_kpa, double best_kpa);

}  // namespace palpate

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

}  // namespace palpate

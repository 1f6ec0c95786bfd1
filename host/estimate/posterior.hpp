// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "host/estimate/objective.hpp"
#include "host/estimate/quasi_newton.hpp"

namespace palpate {

/// Half the 95 % quantile of chi squared with one degree of freedom: F rises by this at the ends of
/// a 95 % profile interval.
constexpr double profile_rise = 1.920729;

/// Inverse of the curvature of F at its minimum; directions without curvature get the prior's
/// variance.
Eigen::MatrixXd laplace_covariance(const Objective& problem, const Eigen::VectorXd& theta);

/// F along one unknown, the others following.
struct Profile {
    std::vector<double> value;      ///< of the unknown, ascending
    std::vector<double> objective;  ///< F less its minimum over the profile
};

/// How far a profile reaches to either side.
double profile_half_width(const Eigen::MatrixXd& covariance, Index unknown);

/// F along unknown `unknown`, the others following the ridge (conditional mean of the Laplace
/// posterior), over 4 standard deviations to either side.
Profile profile_of(const Objective& problem, const Eigen::VectorXd& theta,
                   const Eigen::MatrixXd& covariance, Index unknown);

/// Where the profile has risen by `profile_rise` on either side of `best`; the end of the profile
/// where it never does.
std::array<double, 2> profile_interval(const Profile& profile, double best);

/// Standard deviations [num_unknown] that the priors and the `information` of what is seen
/// (`Objective::seen_information`) leave together. The curvature of F counts more: a wall that
/// stands still, where its prior expects millimetres of sliding, makes stiff tissue likely. That is
/// knowledge of the prior, not of the images.
Eigen::VectorXd seen_sd(const Eigen::MatrixXd& information, const std::vector<Unknown>& unknowns);

/// Of the data over their noise with respect to the unknowns over their prior standard deviations,
/// what is not looked for projected out. Along a direction with singular value s the data narrow
/// the prior by the factor 1 / sqrt(1 + s^2).
struct ScaledSensitivity {
    Eigen::VectorXd singular_values;  ///< [num_unknown], largest first
    Eigen::MatrixXd directions;       ///< [num_unknown, num_unknown], columns of unit length
};
ScaledSensitivity scaled_sensitivity(const Eigen::MatrixXd& information,
                                     const std::vector<Unknown>& unknowns);

/// Whether the data without the prior exclude the lowest and the highest value of `bounds`: the
/// misfit there is larger by `profile_rise` than at theta, both with the other unknowns held and
/// with them along the ridge.
std::array<bool, 2> excluded_ends(const Objective& problem, const Eigen::VectorXd& theta,
                                  const Eigen::MatrixXd& covariance, Index unknown,
                                  const Bounds& bounds);

}  // namespace palpate

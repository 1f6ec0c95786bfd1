// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "host/inverse/marginal.hpp"
#include "host/inverse/modulus_search.hpp"
#include "host/inverse/records.hpp"

namespace palpate {

/// Half the 95 % quantile of chi squared with one degree of freedom: F rises by this at the ends of
/// a 95 % profile interval.
constexpr double profile_rise = 1.920729;

/// Inverse of the curvature of F at its minimum; directions without curvature get the prior's
/// variance.
Eigen::MatrixXd laplace_covariance(const ModulusObjective& problem, const Eigen::VectorXd& theta);

/// How far in ln E a profile reaches to either side.
double profile_half_width(const Eigen::MatrixXd& covariance, Index unknown);

/// F along ln E_k, the other moduli following the ridge (conditional mean of the Laplace
/// posterior), over at least +-4 standard deviations.
ProfileResult profile_of(const ModulusObjective& problem, const Eigen::VectorXd& theta,
                         const Eigen::MatrixXd& covariance, Index unknown);

/// Where the profile has risen by `profile_rise` on either side, kPa; the end of the profile where
/// it never does.
std::array<double, 2> profile_interval(const ProfileResult& profile, double best_kpa);

/// Standard deviations of ln E [num unknown] that prior and `information` of the motion that is
/// seen
/// (`ModulusObjective::seen_information`) leave together. The curvature of F counts more: a wall
/// that stands still, where its prior expects millimetres of sliding, makes stiff tissue likely.
/// That is knowledge of the prior, not of the images.
Eigen::VectorXd seen_sd_ln(const Eigen::MatrixXd& information,
                           const std::vector<ModulusPrior>& priors);

/// Of the observed distances over their noise with respect to ln E over its prior standard
/// deviation, the wall motion projected out. Along a direction with singular value s the images
/// narrow the prior by the factor 1 / sqrt(1 + s^2).
struct ScaledSensitivity {
    Eigen::VectorXd singular_values;  ///< [num unknown], largest first
    Eigen::MatrixXd directions;       ///< [num unknown, num unknown], columns of unit length
};
ScaledSensitivity scaled_sensitivity(const Eigen::MatrixXd& information,
                                     const std::vector<ModulusPrior>& priors);

/// Whether the data without the prior exclude the softest and the stiffest modulus of `bounds`: the
/// misfit there is larger by `profile_rise` than at theta, both with the other moduli held and with
/// them along the ridge.
std::array<bool, 2> excluded_ends(const ModulusObjective& problem, const Eigen::VectorXd& theta,
                                  const Eigen::MatrixXd& covariance, Index unknown,
                                  const ModulusBounds& bounds);

/// Standard deviation of ln E that the model itself adds: linear tetrahedra of the default size,
/// surfaces drawn from voxels, walls that slid otherwise than expected. Of 14 phantoms with exact
/// contours of two generators, one of which shares no code with palpate, the root mean square of
/// the error over the claimed standard deviation was 1.06 with it.
constexpr double model_sd_ln = 0.17;
/// The same for each mm that the contours of one image are off: distances to a wrong contour say
/// where along itself a wall has gone, and say it wrongly. Of 22 phantoms of both generators with
/// contours 0.5 mm off, that root mean square was 1.7 without it and 1.0 with it.
constexpr double model_sd_ln_per_contour_mm = 1.3;
constexpr double most_model_sd_ln = 0.8;

/// Both together; `contour_mm` is of both images together (NoiseLevel).
double model_sd_ln_with(double contour_mm);

/// The interval with a further, independent standard deviation of ln E added in quadrature on
/// either side.
std::array<double, 2> with_further_sd(const std::array<double, 2>& interval_kpa, double best_kpa,
                                      double sd_ln);

/// The same with the model's own uncertainty.
std::array<double, 2> with_model_error(const std::array<double, 2>& interval_kpa, double best_kpa,
                                       double contour_mm = 0);

}  // namespace palpate

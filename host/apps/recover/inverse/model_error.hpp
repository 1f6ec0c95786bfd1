// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "host/estimate/objective.hpp"

namespace palpate {

/// Standard deviation of ln E that the model itself adds: linear tetrahedra of the default size and
/// surfaces drawn from voxels.
constexpr double model_sd_ln = 0.12;
/// By which what the data tell is less certain than their noise says: the kernel of the contours
/// and the motion along walls are not known. Where little is told, it is a difference of large
/// effects, and what is wrong of them is as large as what is told. Of 76 phantoms with exact
/// contours and 32 with drawn ones, of two generators of which one shares no code with palpate,
/// the likelihood of the errors was largest with 1.4 (docs/studies.md has those it was tried on).
constexpr double data_sd_factor = 1.4;
/// As model_sd_ln, for each mm that the contours of one image are off: distances to a wrong contour
/// say where along itself a wall has gone, and say it wrongly.
constexpr double model_sd_ln_per_contour_mm = 1.3;
constexpr double most_model_sd_ln = 0.8;

/// Share of what the size of the elements has changed of ln E that stays unknown.
constexpr double unknown_share_of_mesh = 0.5;

/// All that the model adds together; `contour_mm` is of both images together (NoiseLevel),
/// `mesh_change_ln` what the size of the elements has changed.
double model_sd_ln_with(double contour_mm, double mesh_change_ln = 0);

/// What is known of a modulus, normal in ln E on either side.
struct KnownModulus {
    double kpa = 0;
    std::array<double, 2> interval_kpa{0, 0};  ///< 95 %
    double sd_ln = 0;
};

/// A standard deviation of ln E from the data and a prior, as this says it, and as it is with
/// the model's own uncertainty `model_sd` (model_sd_ln_with), which makes the data tell less:
///   1/s^2 = 1 / (data_sd_factor^2 / i + model^2) + 1 / prior^2,   i = 1 / sd^2 - 1 / prior^2.
double sd_ln_with_model_error(double sd_ln, double prior_sd_ln, double model_sd);

/// Moduli of which some of what the data tell is believed, ln E.
struct BelievedModuli {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};
/// Where data that tell less leave the moduli's ln E, which a search found at `theta` with
/// `covariance`, each with its `model_sd` [num unknown]: the less the data tell, the more of what
/// was assumed is believed. With m and P the priors' means and precisions, C the covariance, D =
/// C^-1 - P what the data tell, M = diag(model^2) and f = data_sd_factor, the mean and covariance
///   m + S (f^2 + D M)^-1 C^-1 (theta - m),   S = (P + V^-1)^-1,   V^-1 = D (f^2 + M D)^-1.
BelievedModuli believed_moduli(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance,
                               const std::vector<Unknown>& priors, const Eigen::VectorXd& model_sd);

/// What is to be told of a modulus that a search found: about `kpa`, either side of the interval as
/// the standard deviation above.
KnownModulus with_model_error(const KnownModulus& found, double kpa, double prior_sd_ln,
                              double model_sd);

/// Of targets, the share whose images mislead: of some 150 phantoms of two generators one was off
/// by seven times the standard deviation that was left to it (docs/studies.md).
constexpr double misled_share = 0.01;
/// How many times the standard deviation that the data claim theirs then is.
constexpr double misled_sd_factor = 5;
/// How probable it must be that images mislead for the answer to be another one.
constexpr double contradiction_probability = 0.1;

/// A modulus where the images may have misled.
struct DoubtedModulus {
    KnownModulus known;
    double misled_probability = 0;  ///< that they have
};

/// `found`, whose prior of ln E is `prior`, if images mislead now and then: with d and v the mean
/// and variance that the data alone give ln E,
///   d ~ (1 - e) N(m_p, s_p^2 + v) + e N(m_p, s_p^2 + k^2 v),   e = misled_share, k =
///   misled_sd_factor,
/// so that the farther d is from what the prior expects, the more probable it is that they have;
/// the modulus is then the mixture of both posteriors, told by its mean, standard deviation and
/// quantiles of 2.5 and 97.5 % (contaminated normal: Tukey 1960; conflict of prior and data: Evans
/// and Moshonov 2006). d and v follow from `found.kpa` and the standard deviation `believed_sd_ln`
/// that belongs to it (BelievedModuli). Empty where the data tell nothing.
std::optional<DoubtedModulus> with_misled_data(const KnownModulus& found, double believed_sd_ln,
                                               const Unknown& prior);

}  // namespace palpate

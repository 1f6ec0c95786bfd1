// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "host/apps/recover/inverse/ratio_mixture.hpp"

namespace palpate {

/// What one set of Poisson's ratios leads to.
struct RatioTrial {
    Eigen::VectorXd ratios;  ///< [num ratios]
    double objective = 0;    ///< minus the log posterior of everything else at its best
    Eigen::VectorXd theta;   ///< ln E there [num unknown moduli]
};

/// Searches everything else at given ratios.
using RatioEvaluation = std::function<RatioTrial(const Eigen::VectorXd& ratios)>;

struct RatioSearchOptions {
    double lowest = 0.25, highest = 0.49;  ///< equally likely between these two
    double first_step = 0.04;
    double tolerance = 0.002;  ///< the search ends when it would change ratios by less
    int max_evaluations = 60;
};

/// Whether a best ratio is an end of the allowed range.
enum class RatioLimit { none, lowest, highest };

struct RatioPosterior {
    RatioTrial best;
    /// [num ratios, num ratios], of the curvature of the objective; no wider than what the prior
    /// allows.
    Eigen::MatrixXd covariance;
    /// [num ratios] how far the 95 % interval reaches below and above the best ratio, the limits
    /// notwithstanding. At a limit only what points inside says anything.
    std::vector<std::array<double, 2>> reach;
    std::vector<RatioLimit> at_limit;  ///< [num ratios]
    int evaluations = 0;
    bool converged = false;  ///< whether the search ended by its tolerance
};

/// The most probable Poisson's ratios between two limits. An evaluation condenses the model anew
/// and has no derivatives, so quadratic interpolation in a trust region goes down (BOBYQA, Powell
/// 2009, of NLopt), and a paraboloid through the trials, the lowest counting most, gives
/// the covariance. The first trial is at `start`.
RatioPosterior search_ratios(const RatioEvaluation& evaluate, const Eigen::VectorXd& start,
                             const RatioSearchOptions& options);

/// What each ratio does to the moduli, which is strongly curved towards 0.5: trials at the best
/// ratios and at 0.7 and 1.5 times the reach of each, the others following along the covariance.
std::vector<RatioScan> scan_ratios(const RatioEvaluation& evaluate, const RatioPosterior& posterior,
                                   const RatioSearchOptions& options);

/// Standard deviation of a ratio that the model itself adds: on phantoms with 1 mm voxels (seeds 21
/// to 26, 0.30 and 0.45) with a load that shows the ratio well, it was off by up to 0.036.
constexpr double ratio_model_sd = 0.03;

/// A reach with the model's own uncertainty added in quadrature.
std::array<double, 2> with_ratio_model_error(const std::array<double, 2>& reach);

}  // namespace palpate

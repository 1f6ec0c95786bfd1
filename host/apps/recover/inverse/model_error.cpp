// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/model_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {

namespace {

constexpr double normal_95 = 1.96;  // standard deviations

double square(double x) { return x * x; }

/// What the data tell of ln E, 1 / its variance.
double information(double sd_ln, double prior_sd_ln) {
    return std::max(0.0, 1 / square(sd_ln) - 1 / square(prior_sd_ln));
}

}  // namespace

double model_sd_ln_with(double contour_mm, double mesh_change_ln) {
    const double per_image = contour_mm / std::numbers::sqrt2;
    const double of_contours =
        std::min(most_model_sd_ln, std::hypot(model_sd_ln, model_sd_ln_per_contour_mm * per_image));
    return std::hypot(of_contours, unknown_share_of_mesh * mesh_change_ln);
}

double sd_ln_with_model_error(double sd_ln, double prior_sd_ln, double model_sd) {
    // Holds for data that tell nothing, i = 0, and everything, i = infinity.
    const double i = information(sd_ln, prior_sd_ln);
    const double of_data = 1 / (square(data_sd_factor) / i + square(model_sd));
    return 1 / std::sqrt(of_data + 1 / square(prior_sd_ln));
}

Eigen::VectorXd believed_mean(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance,
                              const std::vector<Unknown>& priors, const Eigen::VectorXd& model_sd) {
    const Index n = theta.size();
    Eigen::VectorXd mean(n), precision(n);
    for (Index k = 0; k < n; ++k) {
        mean[k] = priors[k].mean;
        precision[k] = 1 / square(priors[k].sd);
    }
    const Eigen::MatrixXd both = covariance.inverse();  // C^-1
    Eigen::MatrixXd data = both;                        // D
    data.diagonal() -= precision;
    Eigen::MatrixXd left = data * model_sd.cwiseAbs2().asDiagonal();  // f^2 + D M
    left.diagonal().array() += square(data_sd_factor);
    // V^-1 = D (f^2 + M D)^-1 = (f^2 + D M)^-1 D
    Eigen::MatrixXd believed = left.partialPivLu().solve(data);
    believed.diagonal() += precision;
    const Eigen::VectorXd pull = left.partialPivLu().solve(both * (theta - mean));
    return mean + believed.partialPivLu().solve(pull);
}

KnownModulus with_model_error(const KnownModulus& found, double kpa, double prior_sd_ln,
                              double model_sd) {
    const auto factor = [&](double half_width) {
        const double sd_ln = sd_ln_with_model_error(half_width / normal_95, prior_sd_ln, model_sd);
        return std::exp(normal_95 * sd_ln);
    };
    const auto& [low, high] = found.interval_kpa;
    return {kpa,
            {kpa / factor(std::log(found.kpa / low)), kpa * factor(std::log(high / found.kpa))},
            sd_ln_with_model_error(found.sd_ln, prior_sd_ln, model_sd)};
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/model_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/tools/roots.hpp>
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

/// Of a normal distribution, up to a constant.
double log_density(double x, double mean, double variance) {
    return -0.5 * (square(x - mean) / variance + std::log(variance));
}

/// A normal distribution whose two sides may differ; half of it lies on either.
struct Sides {
    double mean = 0, sd_below = 1, sd_above = 1;
    double below(double x) const {
        return boost::math::cdf(boost::math::normal(mean, x < mean ? sd_below : sd_above), x);
    }
};

/// Where `probability` of (1 - w) `usual` + w `misled` lies below.
double quantile(const Sides& usual, const Sides& misled, double w, double probability) {
    const auto excess = [&](double x) {
        return (1 - w) * usual.below(x) + w * misled.below(x) - probability;
    };
    const auto farthest = [&](const Sides& part) {
        return 10 * std::max(part.sd_below, part.sd_above);
    };
    const double low = std::min(usual.mean - farthest(usual), misled.mean - farthest(misled));
    const double high = std::max(usual.mean + farthest(usual), misled.mean + farthest(misled));
    const auto [below, above] = boost::math::tools::bisect(
        excess, low, high, boost::math::tools::eps_tolerance<double>(40));
    return (below + above) / 2;
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

BelievedModuli believed_moduli(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance,
                               const std::vector<Unknown>& priors,
                               const Eigen::VectorXd& model_sd) {
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
    const Eigen::MatrixXd left_open = believed.inverse();  // S
    return {mean + left_open * pull, left_open};
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

std::optional<DoubtedModulus> with_misled_data(const KnownModulus& found, double believed_sd_ln,
                                               const Unknown& prior) {
    const double prior_variance = square(prior.sd);
    const double precision = 1 / square(believed_sd_ln);
    const double of_data = precision - 1 / prior_variance;  // 1/v
    const double ln_kpa = std::log(found.kpa);
    if (!(of_data > 0) || !std::isfinite(of_data) || !std::isfinite(ln_kpa)) return std::nullopt;
    const double data = (precision * ln_kpa - prior.mean / prior_variance) / of_data;  // d

    // w / (1 - w) = e N(d; m_p, s_p^2 + k^2 v) / ((1 - e) N(d; m_p, s_p^2 + v))
    const double v = 1 / of_data, misled_v = square(misled_sd_factor) * v;
    const double ln_odds = std::log(misled_share / (1 - misled_share)) +
                           log_density(data, prior.mean, prior_variance + misled_v) -
                           log_density(data, prior.mean, prior_variance + v);
    const double w = 1 / (1 + std::exp(-ln_odds));

    const double misled_sd = 1 / std::sqrt(1 / prior_variance + 1 / misled_v);
    const double misled_mean = square(misled_sd) * (prior.mean / prior_variance + data / misled_v);
    const Sides usual{ln_kpa, std::log(found.kpa / found.interval_kpa[0]) / normal_95,
                      std::log(found.interval_kpa[1] / found.kpa) / normal_95};
    const Sides misled{misled_mean, misled_sd, misled_sd};
    const double mean = (1 - w) * ln_kpa + w * misled_mean;
    const double variance = (1 - w) * square(found.sd_ln) + w * square(misled_sd) +
                            w * (1 - w) * square(misled_mean - ln_kpa);
    const double tail = 0.025;
    const KnownModulus known{std::exp(mean),
                             {std::exp(quantile(usual, misled, w, tail)),
                              std::exp(quantile(usual, misled, w, 1 - tail))},
                             std::sqrt(variance)};
    return DoubtedModulus{known, w};
}

}  // namespace palpate

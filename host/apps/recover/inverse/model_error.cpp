// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/model_error.hpp"

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
    const double i = information(sd_ln, prior_sd_ln);
    // 1 / (f^2 / i + model^2) = i / (f^2 + i model^2)
    const double of_data = i / (square(data_sd_factor) + i * square(model_sd));
    return 1 / std::sqrt(of_data + 1 / square(prior_sd_ln));
}

KnownModulus with_model_error(const KnownModulus& found, const Unknown& prior, double model_sd) {
    const double i = information(found.sd_ln, prior.sd);
    const double g = (1 + square(prior.sd) * i) /
                     (square(data_sd_factor) + i * (square(prior.sd) + square(model_sd)));
    const double ln_kpa = prior.mean + g * (std::log(found.kpa) - prior.mean);
    const auto half_width = [&](double half_width_found) {
        return normal_95 * sd_ln_with_model_error(half_width_found / normal_95, prior.sd, model_sd);
    };
    const auto& [low, high] = found.interval_kpa;
    return {std::exp(ln_kpa),
            {std::exp(ln_kpa - half_width(std::log(found.kpa / low))),
             std::exp(ln_kpa + half_width(std::log(high / found.kpa)))},
            sd_ln_with_model_error(found.sd_ln, prior.sd, model_sd)};
}

}  // namespace palpate

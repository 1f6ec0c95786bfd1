// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/model_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {

std::array<double, 2> with_further_sd(const std::array<double, 2>& interval_kpa, double best_kpa,
                                      double sd_ln) {
    const double below = std::hypot(std::log(best_kpa / interval_kpa[0]), 1.96 * sd_ln);
    const double above = std::hypot(std::log(interval_kpa[1] / best_kpa), 1.96 * sd_ln);
    return {best_kpa * std::exp(-below), best_kpa * std::exp(above)};
}

double model_sd_ln_with(double contour_mm, double mesh_change_ln) {
    const double per_image = contour_mm / std::numbers::sqrt2;
    const double of_contours =
        std::min(most_model_sd_ln, std::hypot(model_sd_ln, model_sd_ln_per_contour_mm * per_image));
    return std::hypot(of_contours, unknown_share_of_mesh * mesh_change_ln);
}

namespace {

/// Of the data and the prior alone, what the data tell worth less.
double stretched_sd_ln(double sd_ln, double prior_sd_ln) {
    const double of_prior = 1.0 / (prior_sd_ln * prior_sd_ln);
    const double of_data = std::max(0.0, 1.0 / (sd_ln * sd_ln) - of_prior);
    return 1.0 / std::sqrt(of_data / (data_sd_factor * data_sd_factor) + of_prior);
}

}  // namespace

double sd_ln_with_model_error(double sd_ln, double prior_sd_ln, double model_sd) {
    return std::hypot(stretched_sd_ln(sd_ln, prior_sd_ln), model_sd);
}

std::array<double, 2> with_model_error(const std::array<double, 2>& interval_kpa, double best_kpa,
                                       double sd_ln, double prior_sd_ln, double model_sd) {
    const double stretch = std::max(1.0, stretched_sd_ln(sd_ln, prior_sd_ln) / sd_ln);
    const std::array<double, 2> stretched{best_kpa * std::pow(interval_kpa[0] / best_kpa, stretch),
                                          best_kpa * std::pow(interval_kpa[1] / best_kpa, stretch)};
    return with_further_sd(stretched, best_kpa, model_sd);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate {

/// What the best estimate becomes as one Poisson's ratio leaves its best value, the others
/// following: at points in the order of the ratio, the best among them.
struct RatioScan {
    std::vector<double> ratio;
    std::vector<double> rise;          ///< of the objective above its lowest, 0 or more
    Eigen::MatrixXd theta;             ///< change of ln E [moduli, points]
    double lowest = 0, highest = 0.5;  ///< the ratio lies between these
};

/// The posterior of ln E over one ratio: the ratio's probabilities and the change of ln E there.
/// With z = -+ sqrt(2 rise) and ln E linear between the points and beyond them,
///   p(nu) ~ exp(-z(nu)^2 / 2) * N(0, further_sd^2)   (a convolution, cut at both limits).
struct RatioMixture {
    Eigen::VectorXd weight;  ///< [grid] sum 1
    Eigen::MatrixXd theta;   ///< change of ln E [moduli, grid]
};
RatioMixture mixture_of(const RatioScan& scan, double further_sd);

/// Second moments of the change of ln E about the best estimate [moduli, moduli].
Eigen::MatrixXd spread_of(const RatioMixture& mixture);

/// The 95 % interval of modulus `k` (2.5 and 97.5 % of the mixture), each part of which is spread
/// as `interval_kpa` about `best_kpa`, normal in ln E on either side.
std::array<double, 2> mixed_interval(const RatioMixture& mixture, Eigen::Index k,
                                     const std::array<double, 2>& interval_kpa, double best_kpa);

}  // namespace palpate

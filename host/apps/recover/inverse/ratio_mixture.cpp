// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/ratio_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate {
namespace {

constexpr int grid_points = 121;
constexpr double normal_95 = 1.96;  // standard deviations

/// A function that is linear between points and beyond them.
double interpolated(const std::vector<double>& x, const Eigen::VectorXd& y, double at) {
    if (x.size() == 1) return y[0];
    const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, at);
    const Eigen::Index k = above - x.begin();
    const double t = (at - x[k - 1]) / (x[k] - x[k - 1]);
    return y[k - 1] + t * (y[k] - y[k - 1]);
}

/// Below its best value a ratio is that many standard deviations low, above it high.
Eigen::VectorXd deviations(const RatioScan& scan) {
    const auto best = std::min_element(scan.rise.begin(), scan.rise.end()) - scan.rise.begin();
    Eigen::VectorXd z(scan.rise.size());
    for (Eigen::Index p = 0; p < z.size(); ++p)
        z[p] = std::copysign(std::sqrt(2.0 * std::max(0.0, scan.rise[p])), double(p - best));
    return z;
}

Eigen::VectorXd convolved(const Eigen::VectorXd& density, double sd_in_steps) {
    if (!(sd_in_steps > 0)) return density;
    Eigen::VectorXd result(density.size());
    for (Eigen::Index i = 0; i < density.size(); ++i) {
        result[i] = 0;
        for (Eigen::Index j = 0; j < density.size(); ++j)
            result[i] += density[j] * std::exp(-0.5 * std::pow(double(i - j) / sd_in_steps, 2));
    }
    return result;
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

}  // namespace

RatioMixture mixture_of(const RatioScan& scan, double further_sd) {
    const Eigen::VectorXd z = deviations(scan);
    const double step = (scan.highest - scan.lowest) / (grid_points - 1);
    RatioMixture mixture;
    mixture.theta.resize(scan.theta.rows(), grid_points);
    Eigen::VectorXd density(grid_points);
    for (int g = 0; g < grid_points; ++g) {
        const double ratio = scan.lowest + g * step;
        density[g] = std::exp(-0.5 * std::pow(interpolated(scan.ratio, z, ratio), 2));
        for (Eigen::Index m = 0; m < scan.theta.rows(); ++m)
            mixture.theta(m, g) = interpolated(scan.ratio, scan.theta.row(m).transpose(), ratio);
    }
    density = convolved(density, further_sd / step);
    mixture.weight = density / density.sum();
    return mixture;
}

Eigen::MatrixXd spread_of(const RatioMixture& mixture) {
    return mixture.theta * mixture.weight.asDiagonal() * mixture.theta.transpose();
}

std::array<double, 2> mixed_interval(const RatioMixture& mixture, Eigen::Index k,
                                     const std::array<double, 2>& interval_kpa, double best_kpa) {
    constexpr double least = 1e-9;
    const double below = std::max(least, std::log(best_kpa / interval_kpa[0]) / normal_95);
    const double above = std::max(least, std::log(interval_kpa[1] / best_kpa) / normal_95);
    const auto share_below = [&](double change) {  // P(ln E < ln best + change)
        double sum = 0;
        for (Eigen::Index g = 0; g < mixture.weight.size(); ++g) {
            const double off = change - mixture.theta(k, g);
            sum += mixture.weight[g] * normal_cdf(off / (off < 0 ? below : above));
        }
        return sum;
    };
    const auto quantile = [&](double share) {
        double low = mixture.theta.row(k).minCoeff() - 10 * below;
        double high = mixture.theta.row(k).maxCoeff() + 10 * above;
        while (high - low > 1e-6 * (1 + std::abs(low))) {
            const double middle = 0.5 * (low + high);
            (share_below(middle) < share ? low : high) = middle;
        }
        return 0.5 * (low + high);
    };
    return {best_kpa * std::exp(std::min(0.0, quantile(0.025))),
            best_kpa * std::exp(std::max(0.0, quantile(0.975)))};
}

}  // namespace palpate

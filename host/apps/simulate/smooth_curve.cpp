// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/smooth_curve.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

/// With secants d_k over steps h_k the slope within is (h_(k-1) d_k + h_k d_(k-1)) / (h_(k-1) +
/// h_k); at the first point d_0 + (d_0 - d_1) h_0 / (h_0 + h_1), and alike at the last.
SmoothCurve::SmoothCurve(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), slope_(x_.size()) {
    const std::size_t last = x_.size() - 1;
    const auto step = [&](std::size_t k) { return x_[k + 1] - x_[k]; };
    const auto secant = [&](std::size_t k) { return (y_[k + 1] - y_[k]) / step(k); };
    for (std::size_t k = 1; k < last; ++k)
        slope_[k] = (step(k - 1) * secant(k) + step(k) * secant(k - 1)) / (step(k - 1) + step(k));
    slope_[0] = secant(0) + (secant(0) - secant(1)) * step(0) / (step(0) + step(1));
    slope_[last] = secant(last - 1) + (secant(last - 1) - secant(last - 2)) * step(last - 1) /
                                          (step(last - 2) + step(last - 1));
}

double SmoothCurve::at(double x) const {
    if (x <= x_.front()) return y_.front() + slope_.front() * (x - x_.front());
    if (x >= x_.back()) return y_.back() + slope_.back() * (x - x_.back());
    const auto after = std::upper_bound(x_.begin(), x_.end(), x);
    const std::size_t k = static_cast<std::size_t>(after - x_.begin()) - 1;
    const double h = x_[k + 1] - x_[k], s = (x - x_[k]) / h;
    // y = (1 + 2s)(1 - s)^2 y_k + s (1 - s)^2 h m_k + s^2 (3 - 2s) y_(k+1) + s^2 (s - 1) h m_(k+1)
    return (1 + 2 * s) * (1 - s) * (1 - s) * y_[k] + s * (1 - s) * (1 - s) * h * slope_[k] +
           s * s * (3 - 2 * s) * y_[k + 1] + s * s * (s - 1) * h * slope_[k + 1];
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/background_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr Index column_step = 5, row_step = 3;  // of the samples
constexpr double kept = 0.9;                    // of what was known, from frame to frame
constexpr float least_sigma = 0.5F;             // of 255: eight bits cannot tell less
constexpr float no_limit = 1e9F;

}  // namespace

BackgroundField::BackgroundField(Index width, Index rows) : width_(width), rows_(rows) {
    residuals_.reserve(std::size_t((width / column_step + 2) * (rows / row_step + 2)));
}

// The basis is 1, u, v, u^2, u v, v^2 with u, v from -1 to 1.
Eigen::Vector3f BackgroundField::column(Index x) const {
    const double u = 2.0 * double(x) / double(width_) - 1, k = 2.0 / double(rows_);
    const Vector6& c = coefficients_;
    // v = k row - 1
    const double p0 = c[0] + c[1] * u + c[3] * u * u, p1 = c[2] + c[4] * u, p2 = c[5];
    return {float(p0 - p1 + p2), float(k * (p1 - 2 * p2)), float(k * k * p2)};
}

void BackgroundField::add_column(double u, const double* powers, const double* values) {
    const double of_u[6] = {1, u, 1, u * u, u, 1};  // times v to the
    constexpr int of_v[6] = {0, 0, 1, 0, 1, 2};
    for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < 6; ++k) normal_(i, k) += of_u[i] * of_u[k] * powers[of_v[i] + of_v[k]];
        right_[i] += of_u[i] * values[of_v[i]];
    }
}

void BackgroundField::gather(const std::vector<float>& columns, Index stride,
                             const std::vector<float>& top, float limit) {
    residuals_.clear();
    for (Index x = 2; x < width_ - 2; x += column_step) {
        const Eigen::Vector3f p = column(x);
        const double u = 2.0 * double(x) / double(width_) - 1, per_row = 2.0 / double(rows_);
        const Index end = std::min(rows_, Index(std::max(0.0F, top[x])));
        // Of a column the basis is (1, u, u^2), (v, u v), v^2: sums of powers of v make it all
        double powers[5] = {}, values[3] = {};
        for (Index y = 1; y < end; y += row_step) {
            const float row = float(y);
            const float value = columns[x * stride + y];
            const float residual = value - (p[0] + row * (p[1] + row * p[2]));
            if (y % 2 == 1)  // every other sample tells the noise as well
                residuals_.push_back(std::abs(residual));
            if (std::abs(residual) > limit) continue;
            const double v = per_row * double(y) - 1, grey = double(value), v2 = v * v;
            powers[0] += 1;
            powers[1] += v;
            powers[2] += v2;
            powers[3] += v2 * v;
            powers[4] += v2 * v2;
            values[0] += grey;
            values[1] += grey * v;
            values[2] += grey * v2;
        }
        add_column(u, powers, values);
    }
    if (residuals_.empty()) return;
    const auto middle = residuals_.begin() + std::ptrdiff_t(residuals_.size() / 2);
    std::nth_element(residuals_.begin(), middle, residuals_.end());
    const float sigma = std::max(least_sigma, 1.4826F * *middle);
    sigma_ = limit == no_limit || sigma_ == 0 ? sigma : 0.8F * sigma_ + 0.2F * sigma;
}

void BackgroundField::solve() {
    Matrix6 normal = normal_;
    const double ridge = 1e-3 * normal(0, 0) + 1e-9;  // of the curved terms: few rows do not tell
    for (int k = 1; k < 6; ++k) normal(k, k) += k < 3 ? 0.1 * ridge : ridge;
    coefficients_ = normal.ldlt().solve(right_);
}

void BackgroundField::begin(const std::vector<float>& columns, Index stride,
                            const std::vector<float>& top) {
    coefficients_.setZero();
    sigma_ = 0;
    float limit = no_limit;
    for (int round = 0; round < 4; ++round) {
        normal_.setZero();
        right_.setZero();
        gather(columns, stride, top, limit);
        solve();
        if (round > 0) limit = 3 * sigma_;
        if (round == 0) sigma_ = 0;
    }
}

void BackgroundField::update(const std::vector<float>& columns, Index stride,
                             const std::vector<float>& top) {
    normal_ *= kept;
    right_ *= kept;
    gather(columns, stride, top, 4 * sigma_);
    solve();
}

}  // namespace palpate

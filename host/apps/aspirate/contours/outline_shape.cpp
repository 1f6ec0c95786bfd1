// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/outline_shape.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "solver/base/multiversion.hpp"

namespace palpate {
namespace {

constexpr double least_spread = 0.5;  // pixels: what nine terms do not follow
constexpr int columns_per_term = 60, least_terms = 4;
constexpr int first_rounds = 8, rounds = 3;

}  // namespace

OutlineShape::OutlineShape(Index width)
    : table_(std::size_t(width)),
      products_(std::size_t(width)),
      weights_(std::size_t(width)),
      rows_(std::size_t(width)) {
    sizes_.reserve(std::size_t(width));
}

// Legendre polynomials, (k + 1) P_{k+1} = (2k + 1) t P_k - k P_{k-1}
OutlineShape::Terms OutlineShape::terms(Index x) const {
    const double t = 2.0 * double(x - first_) / double(last_ - first_) - 1;
    Terms p;
    p[0] = 1;
    p[1] = t;
    for (int k = 1; k + 1 < num_terms; ++k)
        p[k + 1] = ((2 * k + 1) * t * p[k] - k * p[k - 1]) / (k + 1);
    return p;
}

double OutlineShape::row(Index x) const { return rows_[std::clamp(x, first_, last_)]; }

double OutlineShape::spread_of(const std::vector<float>& rows, const std::vector<float>& weights) {
    sizes_.clear();
    for (Index x = first_; x <= last_; ++x)
        if (weights[x] > 0)
            sizes_.push_back(float(std::abs(rows[x] - coefficients_.dot(table_[x]))));
    if (sizes_.empty()) return least_spread;
    const auto middle = sizes_.begin() + std::ptrdiff_t(sizes_.size() / 2);
    std::nth_element(sizes_.begin(), middle, sizes_.end());
    return std::max(least_spread, 1.4826 * *middle);
}

// sums = sum over columns of w p, p the products of the terms of a column
PALPATE_MULTIVERSION
void OutlineShape::add_up(const Products* products, const double* weights, Index count,
                          Products& sums) {
    for (double& sum : sums) sum = 0;
    for (Index x = 0; x < count; ++x)
        for (int k = 0; k < num_products; ++k) sums[k] += weights[x] * products[x][k];
}

void OutlineShape::solve(const std::vector<float>& rows, const std::vector<float>& weights,
                         double scale, bool is_redescending) {
    Terms right = Terms::Zero();
    for (Index x = first_; x <= last_; ++x) {
        double& w = weights_[x];
        w = 0;
        if (!(weights[x] > 0)) continue;
        const double u = (rows[x] - coefficients_.dot(table_[x])) / scale;
        const double tukey = std::abs(u) < 4.7 ? std::pow(1 - u * u / (4.7 * 4.7), 2) : 0;
        w = weights[x] * (is_redescending ? tukey : 1 / std::max(0.3, std::abs(u)));
        right.noalias() += w * double(rows[x]) * table_[x];
    }
    Products sums;
    add_up(&products_[first_], &weights_[first_], last_ - first_ + 1, sums);
    Eigen::Matrix<double, num_terms, num_terms> normal;
    for (int i = 0, at = 0; i < num_terms; ++i)
        for (int k = 0; k <= i; ++k, ++at) normal(i, k) = normal(k, i) = sums[at];
    const int used =
        std::clamp(least_terms + int(last_ - first_) / columns_per_term, least_terms, num_terms);
    // High terms are small; columns that are left out must not let them go anywhere.
    for (int k = 0; k < num_terms; ++k) normal(k, k) += k < used ? 1e-6 + 2e-4 * k * k : 1e9;
    coefficients_ = normal.ldlt().solve(right);
}

void OutlineShape::fit(const std::vector<float>& rows, const std::vector<float>& weights,
                       Index first, Index last) {
    last = std::max(last, first + 1);
    if (first != first_ || last != last_) {
        first_ = first;
        last_ = last;
        for (Index x = first_; x <= last_; ++x) {
            table_[x] = terms(x);
            for (int i = 0, at = 0; i < num_terms; ++i)
                for (int k = 0; k <= i; ++k, ++at) products_[x][at] = table_[x][i] * table_[x][k];
        }
    }
    if (!is_fitted_) {
        for (int round = 0; round < first_rounds; ++round)
            solve(rows, weights, round ? spread_of(rows, weights) : 1e3, false);
        is_fitted_ = true;
    } else {
        solve(rows, weights, 1, false);
        solve(rows, weights, 1, false);
    }
    for (int round = 0; round < rounds; ++round)
        solve(rows, weights, std::min(2.0, spread_of(rows, weights)), true);
    spread_ = spread_of(rows, weights);
    for (Index x = first_; x <= last_; ++x) rows_[x] = coefficients_.dot(table_[x]);
}

}  // namespace palpate

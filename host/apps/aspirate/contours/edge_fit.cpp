// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/edge_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

constexpr Index half_rows = 4;
constexpr int iterations = 3;
constexpr double table_end = 5;  // of Phi
constexpr int steps_per_unit = 64;

/// Phi and its derivative at t, interpolated linearly.
std::array<double, 2> normal_at(double t) {
    struct Table {
        std::array<std::array<double, 2>, std::size_t(2 * table_end * steps_per_unit) + 2> values{};
        Table() {
            for (std::size_t k = 0; k < values.size(); ++k) {
                const double at = double(k) / steps_per_unit - table_end;
                values[k] = {0.5 * std::erfc(-at * M_SQRT1_2),
                             std::exp(-0.5 * at * at) * 0.3989422804014327};
            }
        }
    };
    static const Table table;
    if (t <= -table_end) return {0, 0};
    if (t >= table_end) return {1, 0};
    const double place = (t + table_end) * steps_per_unit;
    const auto k = std::size_t(place);
    const double share = place - double(k);
    const auto &low = table.values[k], &high = table.values[k + 1];
    return {low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1])};
}

}  // namespace

FittedEdge fit_edge(const float* column, Index rows, double first, double width, double dark,
                    double noise) {
    const Index begin = std::clamp<Index>(std::lround(first) - half_rows, 0, rows - 1);
    const Index end = std::min<Index>(std::lround(first) + half_rows + 1, rows);
    double bright = 0;
    const Index from = std::min(end - 1, Index(std::lround(first)) + 2);
    for (Index y = from; y < end; ++y) bright += column[y];
    bright /= double(end - from);
    double a = dark, step = bright - dark, row = first, slope = 0;
    FittedEdge edge;
    Eigen::Matrix4d normal;
    for (int round = 0; round <= iterations; ++round) {
        // Priors: a near dark (4 grey values), d near 0 (3 % of the step per pixel)
        const double noise2 = noise * noise;
        const double slope_weight = noise2 / (9e-4 * step * step + 1e-6), dark_weight = noise2 / 16;
        normal.setZero();
        Eigen::Vector4d right = Eigen::Vector4d::Zero();
        normal(0, 0) = dark_weight;
        normal(3, 3) = slope_weight;
        right[0] = -dark_weight * (a - dark);
        right[3] = -slope_weight * slope;
        double squares = 0, with_width = 0, width_squares = 0;
        for (Index y = begin; y < end; ++y) {
            const double t = (double(y) - row) / width;
            const auto [phi, density] = normal_at(t);
            const double beyond = std::max(0.0, double(y) - row);
            const double residual = column[y] - (a + step * phi + slope * beyond);
            const Eigen::Vector4d g(1, phi, -step * density / width - (beyond > 0 ? slope : 0),
                                    beyond);
            normal.noalias() += g * g.transpose();
            right.noalias() += residual * g;
            squares += residual * residual;
            const double by_width = -step * density * t;
            with_width += residual * by_width;
            width_squares += by_width * by_width;
        }
        if (round == iterations) {
            edge.variance = squares / std::max(1.0, double(end - begin) - 3);
            edge.slope_of_width = with_width;
            edge.weight_of_width = width_squares;
            break;
        }
        normal.diagonal().array() += 1e-9;
        const Eigen::Vector4d change = normal.ldlt().solve(right);
        a += change[0];
        step += change[1];
        row += std::clamp(change[2], -1.0, 1.0);
        slope += change[3];
    }
    normal.diagonal().array() += 1e-9;
    const Eigen::Vector4d unit = normal.ldlt().solve(Eigen::Vector4d::Unit(2));
    edge.row = row;
    edge.step = step;
    edge.sd = std::sqrt(std::max(unit[2], 0.0) * std::max(edge.variance, noise * noise));
    if (!(std::abs(row - first) < 3) || !(step > 0) || !std::isfinite(edge.sd)) {
        edge.row = first;
        edge.sd = 3;
    }
    return edge;
}

}  // namespace palpate

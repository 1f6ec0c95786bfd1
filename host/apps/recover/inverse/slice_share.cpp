// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/slice_share.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace palpate {
namespace {

constexpr double farthest_mm = 12, bin_mm = 1;
constexpr double least_share = 0.25;

/// Weighted sums over pairs of rows whose distance is about the same.
struct Pairs {
    double weight = 0, product = 0, slice = 0, slice_square = 0, product_slice = 0;

    void add(double w, double p, double s) {
        weight += w;
        product += w * p;
        slice += w * s;
        slice_square += w * s * s;
        product_slice += w * p * s;
    }
    double covariance() const { return product_slice - product * slice / weight; }
    double variance() const { return slice_square - slice * slice / weight; }
};

/// One pair of rows, as slice_share_of sees it.
struct Pair {
    double weight, distance_mm, product, slice;
};

/// Residuals less their weighted fit of 1, x, y, z on each surface: what a wrong shift or scale
/// leaves, which is far larger than what single slices do.
Eigen::VectorXd without_trend(const std::vector<LinearRow>& rows, Eigen::VectorXd residual) {
    std::map<Index, std::vector<Index>> surfaces;
    for (std::size_t k = 0; k < rows.size(); ++k)
        surfaces[rows[k].surface].push_back(static_cast<Index>(k));
    for (const auto& [surface, members] : surfaces) {
        Eigen::MatrixXd terms(members.size(), 4);
        Eigen::VectorXd weight(members.size());
        for (std::size_t k = 0; k < members.size(); ++k) {
            const LinearRow& row = rows[members[k]];
            weight[k] = std::sqrt(row.weight);
            terms.row(k) << 1.0, (row.place - rows[members[0]].place).transpose();
        }
        const Eigen::VectorXd trend =
            (weight.asDiagonal() * terms)
                .colPivHouseholderQr()
                .solve(weight.cwiseProduct(Eigen::VectorXd(residual(members))));
        residual(members) -= terms * trend;
    }
    return residual;
}

std::vector<Pair> near_pairs(const std::vector<LinearRow>& rows, const Eigen::VectorXd& residual) {
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const LinearRow &a = rows[i], &b = rows[j];
            if (a.surface != b.surface) continue;
            const double distance = (a.place - b.place).norm();
            if (distance >= farthest_mm) continue;
            pairs.push_back({std::sqrt(a.weight * b.weight), distance,
                             residual[i] * residual[j] - terrace_covariance(a, b, distance),
                             slice_correlation(a.slices, b.slices, distance)});
        }
    }
    return pairs;
}

}  // namespace

double slice_share_of(const std::vector<LinearRow>& rows, const Eigen::VectorXd& residual_mm) {
    const std::vector<Pair> pairs = near_pairs(rows, without_trend(rows, residual_mm));
    std::array<Pairs, static_cast<std::size_t>(farthest_mm / bin_mm)> bins;
    for (const Pair& pair : pairs)
        bins[static_cast<std::size_t>(pair.distance_mm / bin_mm)].add(pair.weight, pair.product,
                                                                      pair.slice);
    double covariance = 0, variance = 0;
    for (const Pairs& bin : bins) {
        if (bin.weight == 0) continue;
        covariance += bin.covariance();
        variance += bin.variance();
    }
    if (!(covariance > 0) || !(variance > 0)) return 0;
    const double by_slice = covariance / variance;
    double along_surface = 0, squares = 0;
    for (const Pair& pair : pairs) {
        const double expected = contour_correlation(pair.distance_mm);
        along_surface += pair.weight * (pair.product - by_slice * pair.slice) * expected;
        squares += pair.weight * expected * expected;
    }
    const double share = by_slice / (by_slice + std::max(0.0, along_surface / squares));
    return share < least_share ? 0.0 : share;
}

}  // namespace palpate

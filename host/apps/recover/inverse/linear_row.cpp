// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/linear_row.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace palpate {
namespace {

/// noise_covariance of two rows whose correlations were computed before.
double known_covariance(const LinearRow& a, const LinearRow& b) {
    const RowCorrelations& known = *a.known;
    const Index i = a.place_in_known, j = b.place_in_known;
    double sum = a.contour_mm * b.contour_mm * known.of_contours(i, j, a.slice_share);
    for (int k = 0; k < max_terraces; ++k) {
        const double wave = a.terraces.waves.col(k).dot(b.terraces.waves.col(k));
        if (wave != 0) sum += wave * known.of_terraces(i, j, k);
    }
    return sum;
}

}  // namespace

double contour_correlation(const LinearRow& a, const LinearRow& b) {
    const double distance = (a.place - b.place).norm(), share = a.slice_share;
    const double smooth = contour_correlation(distance);
    if (share == 0) return smooth;
    return (1.0 - share) * smooth + share * slice_correlation(a.slices, b.slices, distance);
}

double terrace_covariance(const LinearRow& a, const LinearRow& b, double distance) {
    double sum = 0, range = 0, decay = 0;
    for (int k = 0; k < max_terraces; ++k) {
        const double wave = a.terraces.waves.col(k).dot(b.terraces.waves.col(k));
        if (wave == 0) continue;
        if (a.range_mm[k] != range) {
            range = a.range_mm[k];
            decay = std::exp(-distance / range);
        }
        sum += wave * decay;
    }
    return sum;
}

double noise_covariance(const LinearRow& a, const LinearRow& b) {
    if (a.surface != b.surface) return 0;
    if (a.known && a.known == b.known) return known_covariance(a, b);
    return a.contour_mm * b.contour_mm * contour_correlation(a, b) +
           terrace_covariance(a, b, (a.place - b.place).norm());
}

double contour_variance(const LinearRow& row) {
    return row.contour_mm * row.contour_mm * contour_correlation(row, row);
}

double correlated_variance(const LinearRow& row) {
    return row.terraces.variance() + contour_variance(row);
}

double noise_variance(const LinearRow& row) {
    return row.independent_mm * row.independent_mm + correlated_variance(row);
}

void remember_correlations(std::vector<LinearRow>& rows) {
    std::map<std::pair<Index, bool>, std::vector<Index>> groups;
    for (std::size_t k = 0; k < rows.size(); ++k)
        groups[{rows[k].surface, rows[k].on_driven}].push_back(static_cast<Index>(k));
    for (const auto& [surface, members] : groups) {
        std::vector<Vec3> places;
        std::vector<SlicePlaces> slices;
        for (const Index k : members) {
            places.push_back(rows[k].place);
            slices.push_back(rows[k].slices);
        }
        const auto known =
            std::make_shared<const RowCorrelations>(places, slices, rows[members[0]].range_mm);
        for (std::size_t m = 0; m < members.size(); ++m) {
            rows[members[m]].known = known;
            rows[members[m]].place_in_known = static_cast<Index>(m);
        }
    }
}

Eigen::MatrixXd noise_matrix(const std::vector<LinearRow>& rows) {
    const Index n = static_cast<Index>(rows.size());
    Eigen::MatrixXd noise(n, n);
    for (Index j = 0; j < n; ++j) {
        noise(j, j) = noise_variance(rows[j]);
        for (Index i = j + 1; i < n; ++i)
            noise(i, j) = noise(j, i) = noise_covariance(rows[i], rows[j]);
    }
    return noise;
}

}  // namespace palpate

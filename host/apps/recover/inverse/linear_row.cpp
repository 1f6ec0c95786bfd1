// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/linear_row.hpp"

#include <cmath>

#include "host/apps/recover/inverse/row_correlations.hpp"

namespace palpate {

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
    if (a.known && a.known == b.known) return a.known->noise_covariance(a, b);
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

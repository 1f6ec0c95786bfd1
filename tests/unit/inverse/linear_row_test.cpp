// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/linear_row.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

/// Rows of two surfaces, on driven and on observed nodes, whose noise has all of its parts.
std::vector<LinearRow> rows_of_two_surfaces() {
    std::vector<LinearRow> rows;
    for (int k = 0; k < 24; ++k) {
        LinearRow row;
        row.surface = k % 2;
        row.on_driven = k % 3 == 0;
        row.place = Vec3(5 * std::sin(0.7 * k), 4 * std::cos(1.1 * k), 0.8 * k);
        row.independent_mm = 0.1 + 0.01 * k;
        row.contour_mm = 0.4 + 0.02 * k;
        row.slice_share = 0.3;
        row.range_mm = {12, 12, 12, 8, 8, 8};
        for (int wave = 0; wave < max_terraces; ++wave)
            row.terraces.waves.col(wave) << 0.1 * std::cos(k + wave), 0.1 * std::sin(k + wave);
        row.slices[0] = {row.place.z(), Vec3(std::cos(k), std::sin(k), 0) * 0.9, 1.5};
        row.slices[1] = {row.place.z() + 0.3, Vec3(std::cos(k), std::sin(k), 0) * 0.7, 2.5};
        rows.push_back(row);
    }
    return rows;
}

TEST(LinearRow, NoiseIsTheSameWithCorrelationsThatWereComputedBefore) {
    std::vector<LinearRow> rows = rows_of_two_surfaces();
    std::vector<LinearRow> known = rows;
    remember_correlations(known);
    // Whatever else changes, and whichever rows are left out.
    for (std::vector<LinearRow>* all : {&rows, &known}) {
        all->erase(all->begin() + 4);
        for (LinearRow& row : *all) {
            row.contour_mm *= 1.5;
            row.slice_share = 0.6;
            row.terraces.waves *= 2;
        }
    }
    const Eigen::MatrixXd noise = noise_matrix(rows);
    EXPECT_LT((noise_matrix(known) - noise).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_GT(std::abs(noise(2, 7)), 1e-3);
}

TEST(LinearRow, NoiseOfDifferentSurfacesIsIndependent) {
    std::vector<LinearRow> rows = rows_of_two_surfaces();
    remember_correlations(rows);
    EXPECT_EQ(noise_matrix(rows)(0, 1), 0);
    EXPECT_NEAR(noise_matrix(rows)(5, 5), noise_variance(rows[5]), 1e-15);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/apps/aspirate/contours/edge_fit.hpp"

namespace palpate {
namespace {

constexpr Index rows = 40;

std::vector<float> edge_at(double row, double width, double step, double noise, unsigned seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    std::vector<float> column;
    for (Index y = 0; y < rows; ++y)
        column.push_back(
            float(step * 0.5 * std::erfc((row - y) / width * M_SQRT1_2) + noise * normal(engine)));
    return column;
}

TEST(EdgeFit, FindsABlurredEdgeBetweenPixels) {
    for (const double row : {19.0, 20.3, 20.5, 20.9}) {
        const FittedEdge edge = fit_edge(edge_at(row, 1.2, 100, 0, 1).data(), rows, 20, 1.2, 0, 1);

        EXPECT_NEAR(edge.row, row, 0.005);
        EXPECT_NEAR(edge.step, 100, 1);
    }
}

TEST(EdgeFit, ItsErrorIsAtLeastThatOfNoise) {
    constexpr int repeats = 2000;
    double squares = 0, told = 0;
    for (int k = 0; k < repeats; ++k) {
        const FittedEdge edge =
            fit_edge(edge_at(20.3, 1.2, 100, 5, unsigned(k) + 1).data(), rows, 20, 1.2, 0, 5);
        squares += std::pow(edge.row - 20.3, 2) / repeats;
        told += edge.sd * edge.sd / repeats;
    }

    // Of noise and residuals the larger counts, which is more than either on the mean.
    EXPECT_GT(std::sqrt(told / squares), 0.95);
    EXPECT_LT(std::sqrt(told / squares), 1.6);
}

}  // namespace
}  // namespace palpate

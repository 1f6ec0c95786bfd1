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

FittedEdge fit_one(const std::vector<float>& column, Index row, float width, float noise) {
    const EdgePlace place{column.data(), row, width};
    FittedEdge edge;
    fit_edges({&place, 1}, rows, noise, {&edge, 1});
    return edge;
}

TEST(EdgeFit, FindsABlurredEdgeBetweenPixels) {
    for (const double row : {19.0, 20.3, 20.5, 20.9}) {
        const FittedEdge edge =
            fit_one(edge_at(row, 1.2, 100, 0, 1), std::lround(row + 0.5), 1.2F, 1);

        EXPECT_NEAR(edge.row, row, 0.005);
        EXPECT_NEAR(edge.step, 100, 1);
    }
}

TEST(EdgeFit, ItsErrorIsAtLeastThatOfNoise) {
    constexpr int repeats = 2000;
    double squares = 0, told = 0;
    for (int k = 0; k < repeats; ++k) {
        const FittedEdge edge = fit_one(edge_at(20.3, 1.2, 100, 5, unsigned(k) + 1), 21, 1.2F, 5);
        squares += std::pow(edge.row - 20.3, 2) / repeats;
        told += edge.sd * edge.sd / repeats;
    }

    // Of noise and residuals the larger counts, which is more than either on the mean.
    EXPECT_GT(std::sqrt(told / squares), 0.95);
    EXPECT_LT(std::sqrt(told / squares), 1.6);
}

// Eight columns are fitted side by side, and a window may reach beyond the frame.
TEST(EdgeFit, AnEdgeDoesNotKnowItsNeighbours) {
    std::vector<std::vector<float>> columns;
    std::vector<EdgePlace> places;
    for (int k = 0; k < 19; ++k) {
        const Index row = k % 3 == 0 ? 2 : k % 3 == 1 ? rows - 2 : 11 + k;
        const float width = 0.8F + 0.1F * float(k);
        columns.push_back(edge_at(double(row) - 0.3, width, 40 + 5 * k, 2, unsigned(k) + 1));
        places.push_back({columns.back().data(), row, width});
    }

    std::vector<FittedEdge> together(places.size());
    fit_edges(places, rows, 2, together);

    for (std::size_t k = 0; k < places.size(); ++k) {
        FittedEdge alone;
        fit_edges({&places[k], 1}, rows, 2, {&alone, 1});
        EXPECT_EQ(together[k].row, alone.row);
        EXPECT_EQ(together[k].sd, alone.sd);
        EXPECT_NEAR(together[k].row, double(places[k].row) - 0.3, 0.5);
    }
}

TEST(EdgeFit, NothingToFitStaysWhereItIsWithoutAClaim) {
    for (const float grey : {0.0F, 50.0F}) {
        const FittedEdge edge = fit_one(std::vector<float>(rows, grey), 20, 1.2F, 1);

        EXPECT_TRUE(std::isfinite(edge.row));
        EXPECT_GT(edge.sd, 1);
    }
}

}  // namespace
}  // namespace palpate

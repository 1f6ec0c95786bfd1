// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "host/apps/aspirate/contours/column_loops.hpp"

namespace palpate {
namespace {

std::vector<float> random_numbers(Index count, float size) {
    std::mt19937 engine(7);
    std::uniform_real_distribution<float> uniform(-size, size);
    std::vector<float> numbers;
    for (Index k = 0; k < count; ++k) numbers.push_back(uniform(engine));
    return numbers;
}

TEST(ColumnLoops, TurnFramesOfAnySize) {
    for (const Index width : {4, 7, 13})
        for (const Index end : {1, 4, 10}) {
            const std::vector<float> frame = random_numbers(width * end, 100);
            const Index stride = end + 3;
            std::vector<float> columns(std::size_t(width * stride), -1);

            turn_columns(frame.data(), width, end, stride, columns.data());

            for (Index x = 0; x < width; ++x)
                for (Index y = 0; y < stride; ++y)
                    EXPECT_EQ(columns[x * stride + y], y < end ? frame[y * width + x] : -1);
        }
}

TEST(ColumnLoops, SumOfAllRowsBefore) {
    for (const Index end : {1, 3, 4, 11}) {
        const std::vector<float> evidence = random_numbers(end, 4);
        std::vector<float> cost(std::size_t(end) + 1);

        sum_before(evidence.data(), end, cost.data());

        double sum = 0;
        for (Index y = 0; y <= end; ++y) {
            EXPECT_NEAR(cost[y], sum, 1e-5);
            if (y < end) sum += double(evidence[y]);
        }
    }
}

// A step of 30 between rows 19 and 20 earns all there, nothing far away or where light falls.
TEST(ColumnLoops, AStepEarnsWhereItIs) {
    constexpr Index end = 40;
    std::vector<float> residual(end + 4, 0), sums(end), cost(end + 1, 0);
    std::fill(residual.begin() + 20, residual.begin() + 32, 30.0F);

    reward_steps(residual.data(), {1 / 30.0F / 5, 0.5F, 1 / 15.0F, 0.5F}, end, sums.data(),
                 cost.data());

    EXPECT_FLOAT_EQ(cost[20], -1);
    EXPECT_EQ(std::min_element(cost.begin(), cost.end()) - cost.begin(), 20);
    EXPECT_EQ(cost[10], 0);
    EXPECT_EQ(cost[32], 0);
    EXPECT_EQ(cost[end], 0);
}

TEST(ColumnLoops, EvidenceIsBoundedAndTellsTissueFromBackground) {
    const std::vector<float> smooth{0, 2, 48, 50, 1000};
    std::vector<float> evidence(smooth.size());

    pixel_evidence(smooth.data(),
                   {.sigma = 2, .tissue = 50, .sd = 5, .most = 6, .least = 4, .factor = 0.5F},
                   Index(smooth.size()), evidence.data());

    const float width_term = 0.5F * std::log(2.5F);
    EXPECT_FLOAT_EQ(evidence[0], -0.5F * 4);  // bounded
    EXPECT_FLOAT_EQ(evidence[3], 0.5F * 6);   // bounded
    EXPECT_FLOAT_EQ(evidence[4], 0.5F * (8 - 4 - width_term));
    EXPECT_LT(evidence[1], 0);
}

}  // namespace
}  // namespace palpate

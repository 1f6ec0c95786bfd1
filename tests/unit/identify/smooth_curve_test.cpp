// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/smooth_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

TEST(SmoothCurve, IsExactForAParabola) {
    const auto y = [](double x) { return 2 - x + 3 * x * x; };
    const std::vector<double> x{0, 0.3, 1, 1.4, 2};
    std::vector<double> values;
    for (const double one : x) values.push_back(y(one));
    const SmoothCurve curve(x, values);
    for (double at = 0; at <= 2; at += 0.07) EXPECT_NEAR(curve.at(at), y(at), 1e-12) << at;
}

TEST(SmoothCurve, ErrorsOfASineFallWithTheThirdPowerOfTheSteps) {
    const auto largest_error = [](int count) {
        std::vector<double> x, y;
        for (int k = 0; k <= count; ++k) {
            x.push_back(3.0 * k / count);
            y.push_back(std::sin(x.back()));
        }
        const SmoothCurve curve(x, y);
        double error = 0;
        for (double at = 0; at <= 3; at += 0.001)
            error = std::max(error, std::abs(curve.at(at) - std::sin(at)));
        return error;
    };
    EXPECT_GT(largest_error(10) / largest_error(20), 6.5);
}

TEST(SmoothCurve, GoesOnStraightBeyondItsEnds) {
    const SmoothCurve curve({0, 1, 2}, {0, 1, 2});
    EXPECT_DOUBLE_EQ(curve.at(-1), -1);
    EXPECT_DOUBLE_EQ(curve.at(5), 5);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/cubic_bspline.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

constexpr std::array<Index, 3> size{21, 18, 24};

double smooth_function(const Vec3& x) {
    return std::sin(0.3 * x[0]) + std::cos(0.25 * x[1]) * x[2] * 0.1 + 0.01 * x[2] * x[2];
}

std::vector<float> sampled() {
    std::vector<float> volume;
    for (Index k = 0; k < size[2]; ++k)
        for (Index j = 0; j < size[1]; ++j)
            for (Index i = 0; i < size[0]; ++i) volume.push_back(smooth_function(Vec3(i, j, k)));
    return volume;
}

TEST(CubicBspline, PassesThroughTheSamples) {
    const std::vector<float> samples = sampled();
    std::vector<float> coefficients = samples;

    to_bspline_coefficients(size, coefficients);

    for (Index k = 1; k < size[2] - 1; ++k)
        for (Index j = 1; j < size[1] - 1; ++j)
            for (Index i = 1; i < size[0] - 1; ++i)
                ASSERT_NEAR(bspline_value(size, coefficients.data(), Vec3(i, j, k)),
                            samples[i + size[0] * (j + size[1] * k)], 1e-4);
}

TEST(CubicBspline, FollowsASmoothFunctionBetweenTheSamples) {
    std::vector<float> coefficients = sampled();
    to_bspline_coefficients(size, coefficients);

    for (const Vec3& x : {Vec3(8.3, 9.7, 11.5), Vec3(10.9, 7.2, 12.1), Vec3(9.5, 8.5, 9.5)}) {
        EXPECT_NEAR(bspline_value(size, coefficients.data(), x), smooth_function(x), 1e-3);
    }
}

TEST(CubicBspline, GradientIsTheDerivativeOfTheValue) {
    std::vector<float> coefficients = sampled();
    to_bspline_coefficients(size, coefficients);
    const Vec3 x(8.3, 9.7, 11.5);
    const double step = 0.05;  // large: values are summed in single precision

    Vec3 gradient;
    bspline_value(size, coefficients.data(), x, &gradient);

    for (int a = 0; a < 3; ++a) {
        const Vec3 e = step * Vec3::Unit(a);
        const double difference = (bspline_value(size, coefficients.data(), x + e) -
                                   bspline_value(size, coefficients.data(), x - e)) /
                                  (2 * step);
        EXPECT_NEAR(gradient[a], difference, 2e-4);
    }
}

TEST(CubicBspline, MixedDerivativesAreThoseOfTheFunction) {
    std::vector<float> coefficients = sampled();
    to_bspline_coefficients(size, coefficients);
    const Vec3 x(8.3, 9.7, 11.5);

    EXPECT_NEAR(bspline_derivative(size, coefficients.data(), x, {1, 0, 0}),
                0.3 * std::cos(0.3 * x[0]), 2e-3);
    EXPECT_NEAR(bspline_derivative(size, coefficients.data(), x, {0, 0, 2}), 0.02, 2e-3);
    EXPECT_NEAR(bspline_derivative(size, coefficients.data(), x, {0, 1, 1}),
                -0.025 * std::sin(0.25 * x[1]), 2e-3);
    EXPECT_NEAR(bspline_derivative(size, coefficients.data(), x, {0, 0, 0}), smooth_function(x),
                1e-3);
}

TEST(CubicBspline, CanBeEvaluatedAtTheEndsOfItsSupport) {
    std::vector<float> coefficients = sampled();
    to_bspline_coefficients(size, coefficients);

    const Vec3 low = clamped_to_support(size, Vec3(-5, -5, -5));
    const Vec3 high = clamped_to_support(size, Vec3(100, 100, 100));

    EXPECT_NEAR(bspline_value(size, coefficients.data(), low), smooth_function(low), 1e-4);
    EXPECT_NEAR(bspline_value(size, coefficients.data(), high), smooth_function(high), 1e-4);
}

}  // namespace
}  // namespace palpate

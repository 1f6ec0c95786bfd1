// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "solver/materials/finite_strain.hpp"
#include "solver/materials/veronda_westmann.hpp"

namespace palpate {
namespace {

constexpr double rounding = 1e-14;

TEST(MinusLog1p, MatchesWiderNumbersOnBothSidesOfTheSeries) {
    for (long double x : {-0.9L, -0.26L, -0.2499L, -1e-3L, 1e-8L, 0.1L, 0.2499L, 0.26L, 5.0L}) {
        const double narrow = static_cast<double>(x);
        const long double exact = std::abs(x) < 1e-6L
                                      ? x * x * (0.5L - x / 3 + x * x / 4)
                                      : static_cast<long double>(narrow) - log1pl(narrow);
        EXPECT_NEAR(static_cast<double>(minus_log1p(narrow) / exact), 1, 10 * rounding) << narrow;
    }
    EXPECT_EQ(minus_log1p(0.0), 0.0);
}

TEST(ExponentialMoment, MatchesWiderNumbersOnBothSidesOfTheSeries) {
    for (double y : {0.01, 0.3, 0.4999, 0.5001, 2.0, 20.0}) {
        const long double w = y;
        const long double exact = (w * expl(w) - expm1l(w)) / (w * w);
        EXPECT_NEAR(static_cast<double>(exponential_moment(y) / exact), 1, 10 * rounding) << y;
    }
    EXPECT_EQ(exponential_moment(0.0), 0.5);
}

TEST(FiniteStrain, OfAStretchHasItsInvariants) {
    // F = diag(2, 1, 1/4): J = 1/2, I1 = 81/16.
    const FiniteStrain<double> s = finite_strain(Tensor3<double>{{1, 0, 0, 0, 0, 0, 0, 0, -0.75}});

    EXPECT_TRUE(s.is_valid);
    EXPECT_NEAR(s.volume_change, -0.5, rounding);
    EXPECT_NEAR(s.square_stretch, 81.0 / 48, rounding);
    EXPECT_NEAR(s.log_volume, std::log(0.5), rounding);
    EXPECT_NEAR(s.log_distortion, std::log(0.25 / std::pow(81.0 / 48, 3)), rounding);
    EXPECT_NEAR(s.inverse_transposed.m[8], 4, rounding);
    EXPECT_NEAR(s.twice_deviator.m[0], 4 - 81.0 / 48, rounding);
}

TEST(FiniteStrain, LosesNoDigitsOfALargeDistortionInSinglePrecision) {
    // Stretch 10 at constant volume: ln det(I + epsilon) = -3 ln(I1 / 3).
    const double lateral = 1 / std::sqrt(10.0);
    const float change = static_cast<float>(lateral - 1);

    const FiniteStrain<float> s =
        finite_strain(Tensor3<float>{{9, 0, 0, 0, change, 0, 0, 0, change}});

    EXPECT_NEAR(s.log_distortion / (-3 * std::log((100 + 0.2) / 3)), 1, 1e-6);
}

TEST(FiniteStrain, HalfTurnIsValidAndHasNoStrain) {
    const FiniteStrain<double> s = finite_strain(Tensor3<double>{{-2, 0, 0, 0, -2, 0, 0, 0, 0}});

    EXPECT_TRUE(s.is_valid);
    EXPECT_EQ(s.volume_change, 0);
    EXPECT_EQ(s.mean, 0);
    EXPECT_EQ(s.log_distortion, 0);
}

}  // namespace
}  // namespace palpate

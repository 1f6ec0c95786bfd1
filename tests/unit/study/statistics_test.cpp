// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

TEST(Statistics, TakesMeanAndMedian) {
    EXPECT_EQ(mean_of({1, 2, 6}), 3);
    EXPECT_EQ(median_of({6, 1, 2}), 2);
    EXPECT_EQ(median_of({4, 1, 2, 100}), 3);
    EXPECT_TRUE(std::isnan(median_of({})));
}

TEST(BinomialRange, AgreesWithTheClosedFormsAtTheEnds) {
    // All of n hold: the lower end solves p^n = 0.025; none: (1 - p)^n = 0.025.
    const auto all = binomial_range(10, 10), none = binomial_range(0, 10);

    EXPECT_NEAR(all[0], std::pow(0.025, 0.1), 1e-9);
    EXPECT_EQ(all[1], 1);
    EXPECT_EQ(none[0], 0);
    EXPECT_NEAR(none[1], 1 - std::pow(0.025, 0.1), 1e-9);
}

/// P(X <= most) of a binomial distribution.
double probability_up_to(int most, int n, double p) {
    double sum = 0;
    for (int k = 0; k <= most; ++k)
        sum += std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) +
                        k * std::log(p) + (n - k) * std::log(1 - p));
    return sum;
}

TEST(BinomialRange, LeavesTwoAndAHalfPercentOnEitherSide) {
    const auto range = binomial_range(57, 60);

    EXPECT_NEAR(1 - probability_up_to(56, 60, range[0]), 0.025, 1e-6);
    EXPECT_NEAR(probability_up_to(57, 60, range[1]), 0.025, 1e-6);
}

TEST(BinomialRange, OfNoTrialsIsEverything) {
    EXPECT_EQ(binomial_range(0, 0), (std::array<double, 2>{0, 1}));
}

TEST(PairedTest, AgreesWithStudentsTable) {
    // Differences -1, 0, 1, 2, 3: mean 1, standard error sqrt(2.5 / 5); t(4) = 2.776 at 95 %.
    const auto test = paired_t_test({1, 2, 3, 4, 5}, {2, 2, 2, 2, 2});

    EXPECT_DOUBLE_EQ(test.mean_difference, 1);
    EXPECT_NEAR(test.t, std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(test.interval[1], 1 + 2.776445 * std::sqrt(0.5), 1e-5);
    // With 4 degrees of freedom P(|T| > t) = 1 - s (3 - s^2) / 2, s = t / sqrt(4 + t^2).
    const double s = std::sqrt(2.0 / 6.0);
    EXPECT_NEAR(test.p, 1 - s * (3 - s * s) / 2, 1e-9);
}

TEST(PairedTest, IsCertainWithoutScatter) {
    EXPECT_EQ(paired_t_test({1, 2}, {1, 2}).p, 1);
    EXPECT_EQ(paired_t_test({2, 3}, {1, 2}).p, 0);
    EXPECT_THROW(paired_t_test({1}, {1}), Error);
    EXPECT_THROW(paired_t_test({1, 2}, {1}), Error);
}

}  // namespace
}  // namespace palpate

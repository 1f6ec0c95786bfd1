// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/springs/springs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Relative error that the prior, a factor of e^1.2 wide, may leave beside data of 1 % noise.
constexpr double nearly = 0.01;

Outcome outcome_of(const std::string& settings) {
    const Application springs = springs_application();
    const auto values = OptionValues::from_settings(all_options(springs), settings, "test");
    return run_application(springs, values, LimitEnds::work);
}

double value_of(const Outcome& outcome, const char* name) {
    return std::get<double>(find_figure(outcome.result, name)->value);
}

TEST(Springs, ExactMotionGivesBothBack) {
    // k = (5, 2) mN/mm and F = 10 mN: the joint moves by 2 mm, the end by 2 + 5 mm.
    const Outcome outcome = outcome_of("force_mn = 10\njoint_mm = 2\nend_mm = 7\nnoise_mm = 0.01");

    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NEAR(value_of(outcome, "first_mn_per_mm"), 5, 5 * nearly);
    EXPECT_NEAR(value_of(outcome, "second_mn_per_mm"), 2, 2 * nearly);
    for (const char* name : {"first_mn_per_mm", "second_mn_per_mm"})
        EXPECT_EQ(find_figure(outcome.result, name)->verdict, Verdict::recovered);
}

TEST(Springs, TheIntervalIsTheErrorThatNoiseLeaves) {
    // Of the first spring alone: k = F / u, so that sd(ln k) = s / u = 0.05 where u = 2 mm and
    // s = 0.1 mm. What the end says of it, through an unknown second spring, is next to nothing.
    const Outcome outcome = outcome_of("force_mn = 10\njoint_mm = 2\nend_mm = 7\nnoise_mm = 0.1");

    const auto interval = *find_figure(outcome.result, "first_mn_per_mm")->interval_95;

    EXPECT_NEAR(std::log(interval[1] / interval[0]), 2 * 1.96 * 0.05, 0.01);
}

TEST(Springs, WithoutTheJointTheyTradeAndNoneIsRecovered) {
    const Outcome outcome = outcome_of("force_mn = 10\nend_mm = [7, 7.01, 6.99]\nnoise_mm = 0.01");

    for (const char* name : {"first_mn_per_mm", "second_mn_per_mm"}) {
        const Figure& figure = *find_figure(outcome.result, name);
        EXPECT_NE(figure.verdict, Verdict::recovered) << name;
        EXPECT_GT((*figure.interval_95)[1] / (*figure.interval_95)[0], 2.0) << name;
    }
    const double sum_mm =
        10 / value_of(outcome, "first_mn_per_mm") + 10 / value_of(outcome, "second_mn_per_mm");
    EXPECT_NEAR(sum_mm, 7, 7 * nearly);
}

TEST(Springs, NoiseAsLargeAsTheMotionTellsNothing) {
    const Outcome outcome = outcome_of("force_mn = 10\njoint_mm = 2\nend_mm = 7\nnoise_mm = 100");

    EXPECT_EQ(find_figure(outcome.result, "second_mn_per_mm")->verdict, Verdict::not_identifiable);
}

TEST(Springs, IntervalsHoldAsOftenAsTheySay) {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, 0.2);
    constexpr int cases = 200;
    int held = 0;
    for (int k = 0; k < cases; ++k) {
        const Outcome outcome = outcome_of(
            "force_mn = 10\nnoise_mm = 0.2\njoint_mm = " + std::to_string(2 + noise(random)) +
            "\nend_mm = " + std::to_string(7 + noise(random)));
        const auto interval = *find_figure(outcome.result, "second_mn_per_mm")->interval_95;
        held += interval[0] <= 2 && 2 <= interval[1];
    }

    // 95 % of 200 with three standard deviations of the count, 3.1.
    EXPECT_GE(held, 190 - 10);
    EXPECT_LT(held, 200);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "host/apps/aspirate/model/suction.hpp"

namespace palpate {
namespace {

constexpr double end_s = 12;

/// Readings every 0.02 s, of a peak of 5 kPa.
Suction read_off(const std::function<double(double time_s)>& share) {
    Suction suction;
    for (double t = 0; t < end_s + 1e-9; t += 0.02) {
        suction.time_s.push_back(t);
        suction.kpa.push_back(5 * share(t));
    }
    return suction;
}

double ramp(double t) { return std::clamp((t - 1) / 2, 0.0, std::max(0.0, (9 - t) / 2)); }

double trapezoid(double t) { return std::min(1.0, ramp(t)); }

/// Half a cosine up from 1 to 4 s, down from 6 to 9 s.
double smooth(double t) {
    const auto half = [](double along) {
        return 0.5 * (1 - std::cos(std::numbers::pi * std::clamp(along, 0.0, 1.0)));
    };
    return half((t - 1) / 3) - half((t - 6) / 3);
}

/// Where the suction changes: the longest step, and the largest change of the share in one.
struct Coarseness {
    double longest_s = 0, most_change = 0;
};

Coarseness coarseness_of(const SuctionSteps& steps) {
    Coarseness found;
    for (std::size_t k = 1; k < steps.time_s.size(); ++k) {
        const double change = std::abs(steps.share[k] - steps.share[k - 1]);
        found.most_change = std::max(found.most_change, change);
        if (change > 1e-3)
            found.longest_s = std::max(found.longest_s, steps.time_s[k] - steps.time_s[k - 1]);
    }
    return found;
}

TEST(SuctionSteps, AreShortBehindKinksAndTakeATwelfthOfTheSuctionAtMost) {
    const SuctionSteps steps = suction_steps(read_off(trapezoid), end_s, 32);

    EXPECT_LE(coarseness_of(steps).most_change, 1.0 / 12 + 1e-9);
    EXPECT_NEAR(steps.time_s.back(), end_s - 1, 0.05);
    for (const double kink_s : {1.0, 3.0, 7.0, 9.0}) {
        const auto behind =
            std::upper_bound(steps.time_s.begin(), steps.time_s.end(), kink_s - 1 + 0.011);
        const double before_s = behind == steps.time_s.begin() ? 0 : *std::prev(behind);
        EXPECT_LT(*behind - before_s, 0.06) << kink_s;
    }
    EXPECT_LT(steps.time_s.size(), 80u);
}

TEST(SuctionSteps, ComeInPairsThatACoarserModelTakesTogether) {
    for (const auto& share : {trapezoid, smooth}) {
        const SuctionSteps steps = suction_steps(read_off(share), end_s, 32);
        ASSERT_EQ(steps.time_s.size() % 2, 0u);
        for (std::size_t k = 0; k < steps.time_s.size(); k += 2) {
            const double before_s = k == 0 ? 0 : steps.time_s[k - 1];
            EXPECT_NEAR(steps.time_s[k], 0.5 * (before_s + steps.time_s[k + 1]), 1e-9);
        }
    }
    const SuctionSteps steps = suction_steps(read_off(trapezoid), end_s, 32);
    for (const double kink_s : {2.0, 6.0, 8.0}) {  // behind the begin of suction
        const auto end = std::find_if(steps.time_s.begin(), steps.time_s.end(),
                                      [&](double t) { return std::abs(t - kink_s) < 0.021; });
        ASSERT_NE(end, steps.time_s.end()) << kink_s;
        EXPECT_EQ((end - steps.time_s.begin()) % 2, 1) << kink_s;
    }
}

TEST(SuctionSteps, FollowACurveWithoutShortStepsAtEachOfItsChords) {
    const SuctionSteps steps = suction_steps(read_off(smooth), end_s, 32);

    const Coarseness found = coarseness_of(steps);
    EXPECT_LT(found.longest_s, 0.25);
    EXPECT_LT(found.most_change, 0.085);
    double shortest_s = 1;
    for (std::size_t k = 1; k < steps.time_s.size(); ++k)
        if (steps.time_s[k] < 2.5)
            shortest_s = std::min(shortest_s, steps.time_s[k] - steps.time_s[k - 1]);
    EXPECT_GT(shortest_s, 0.04);
    EXPECT_LT(steps.time_s.size(), 110u);
}

}  // namespace
}  // namespace palpate

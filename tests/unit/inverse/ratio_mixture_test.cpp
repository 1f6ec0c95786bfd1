// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/ratio_mixture.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

/// A ratio of 0.37 +- sd, ln E changing by `slope` per unit below the best ratio and by `above`
/// times as much over it.
RatioScan scan_with(double sd, double slope, double above) {
    RatioScan scan;
    scan.lowest = 0.25;
    scan.highest = 0.49;
    scan.theta.resize(1, 5);
    for (int p = 0; p < 5; ++p) {
        const double off = 0.02 * (p - 2);
        scan.ratio.push_back(0.37 + off);
        scan.rise.push_back(0.5 * off * off / (sd * sd));
        scan.theta(0, p) = slope * off * (off > 0 ? above : 1.0);
    }
    return scan;
}

TEST(RatioMixture, OfAStraightLineAddsInQuadrature) {
    const double sd = 0.02, slope = -10, own = 0.15;
    const RatioMixture mixture = mixture_of(scan_with(sd, slope, 1), 0);
    EXPECT_NEAR(mixture.weight.sum(), 1, 1e-12);
    EXPECT_NEAR(std::sqrt(spread_of(mixture)(0, 0)), std::abs(slope) * sd, 0.002);
    const double half = 1.96 * std::hypot(own, slope * sd);
    const auto [low, high] =
        mixed_interval(mixture, 0, {100 * std::exp(-1.96 * own), 100 * std::exp(1.96 * own)}, 100);
    EXPECT_NEAR(std::log(100 / low), half, 0.01);
    EXPECT_NEAR(std::log(high / 100), half, 0.01);
}

TEST(RatioMixture, FollowsAModulusThatFallsSteeplyOnOneSide) {
    const std::array<double, 2> own{90, 111};
    const auto straight = mixed_interval(mixture_of(scan_with(0.03, -5, 1), 0), 0, own, 100);
    const auto bent = mixed_interval(mixture_of(scan_with(0.03, -5, 4), 0), 0, own, 100);
    EXPECT_LT(bent[0], 0.7 * straight[0]);
    EXPECT_NEAR(bent[1], straight[1], 0.02 * straight[1]);
}

TEST(RatioMixture, OfARatioThatNothingShowsReachesAsFarAsItsLimits) {
    RatioScan scan = scan_with(0.02, -10, 1);
    for (double& rise : scan.rise) rise = 0;
    const auto [low, high] = mixed_interval(mixture_of(scan, 0), 0, {99.9, 100.1}, 100);
    EXPECT_NEAR(std::log(low / 100), -10 * 0.12 * 0.95, 0.02);
    EXPECT_NEAR(std::log(high / 100), 10 * 0.12 * 0.95, 0.02);
}

TEST(RatioMixture, AFurtherDeviationOfTheRatioWidensIt) {
    const RatioScan scan = scan_with(0.01, -10, 1);
    EXPECT_NEAR(std::sqrt(spread_of(mixture_of(scan, 0.03))(0, 0)), 10 * std::hypot(0.01, 0.03),
                0.02);
}

TEST(RatioMixture, NeverNarrowsAnInterval) {
    RatioScan alone;
    alone.ratio = {0.4};
    alone.rise = {0};
    alone.theta = Eigen::MatrixXd::Zero(1, 1);
    const auto [low, high] = mixed_interval(mixture_of(alone, 0.03), 0, {80, 130}, 100);
    EXPECT_NEAR(low, 80, 0.05);
    EXPECT_NEAR(high, 130, 0.05);
}

}  // namespace
}  // namespace palpate

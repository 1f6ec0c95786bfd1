// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/trust_region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

double bowl(const Eigen::VectorXd& x) {
    return std::pow(x[0] - 0.3, 2) + 4 * std::pow(x[1] - 0.6, 2) + 0.5 * x[0] * x[1];
}

TEST(TrustRegion, FindsTheMinimumWithoutDerivatives) {
    const NloptMinimum found =
        minimise_in_trust_region(bowl, Eigen::Vector2d(0.9, 0.1), {0, 1, 0.2, 1e-4, 100});

    // 2 (x - 0.3) + y / 2 = 0, 8 (y - 0.6) + x / 2 = 0
    EXPECT_NEAR(found.x[0], 0.152381, 1e-3);
    EXPECT_NEAR(found.x[1], 0.590476, 1e-3);
    EXPECT_TRUE(found.converged);
    EXPECT_LT(found.evaluations, 60);
}

TEST(TrustRegion, StaysWithinItsBoundsAndBeginsThere) {
    double lowest = 1, highest = 0;
    const auto watched = [&](const Eigen::VectorXd& x) {
        lowest = std::min(lowest, x.minCoeff());
        highest = std::max(highest, x.maxCoeff());
        return -x.sum();
    };

    const NloptMinimum found =
        minimise_in_trust_region(watched, Eigen::Vector2d(-3, 7), {0, 1, 0.2, 1e-4, 100});

    EXPECT_GE(lowest, 0);
    EXPECT_LE(highest, 1);
    EXPECT_NEAR(found.x.minCoeff(), 1, 1e-3);
}

TEST(TrustRegion, GivesTheBestPointWhenEvaluationsAreUsedUp) {
    const NloptMinimum found =
        minimise_in_trust_region(bowl, Eigen::Vector2d(0.9, 0.1), {0, 1, 0.2, 1e-9, 8});

    EXPECT_FALSE(found.converged);
    EXPECT_EQ(found.evaluations, 8);
    EXPECT_EQ(found.value, bowl(found.x));
    EXPECT_LT(found.value, bowl(Eigen::Vector2d(0.9, 0.1)));
}

TEST(TrustRegion, LetsExceptionsThroughAndRefusesWhatIsNoNumber) {
    const auto throws = [](const Eigen::VectorXd&) -> double { throw std::runtime_error("mine"); };
    const auto nothing = [](const Eigen::VectorXd&) { return std::nan(""); };

    EXPECT_THROW(minimise_in_trust_region(throws, Eigen::Vector2d(0.5, 0.5), {}),
                 std::runtime_error);
    EXPECT_THROW(minimise_in_trust_region(nothing, Eigen::Vector2d(0.5, 0.5), {}), Error);
}

}  // namespace
}  // namespace palpate

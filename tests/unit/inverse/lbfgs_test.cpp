// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/lbfgs.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

TEST(Lbfgs, FindsTheMinimumOfRosenbrocksValley) {
    const auto valley = [](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        const double a = 1 - x[0], b = x[1] - x[0] * x[0];
        gradient << -2 * a - 400 * x[0] * b, 200 * b;
        return a * a + 100 * b * b;
    };
    LbfgsOptions options;
    options.relative_tolerance = 1e-12;

    const LbfgsResult found = minimise_lbfgs(valley, Eigen::Vector2d(-1.2, 1), options);

    EXPECT_TRUE(found.converged) << found.reason;
    EXPECT_LT((found.x - Eigen::Vector2d::Ones()).norm(), 1e-4);
}

TEST(Lbfgs, StaysWithinBoundsAndLetsExceptionsThrough) {
    const auto slope = [](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        gradient = Eigen::VectorXd::Ones(1);
        return x[0];
    };
    LbfgsOptions options;
    options.lower = Eigen::VectorXd::Constant(1, -2);
    options.upper = Eigen::VectorXd::Constant(1, 2);
    const auto broken = [](const Eigen::VectorXd&, Eigen::VectorXd&) -> double {
        throw Error(ErrorCode::internal, "broken");
    };

    EXPECT_NEAR(minimise_lbfgs(slope, Eigen::VectorXd::Ones(1), options).x[0], -2, 1e-12);
    EXPECT_THROW(minimise_lbfgs(broken, Eigen::VectorXd::Ones(1), options), Error);
}

TEST(Lbfgs, SaysThatAKinkStoppedIt) {
    // The gradient promises a descent that is not there.
    const auto kinked = [](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        gradient = Eigen::VectorXd::Constant(1, -1);
        return std::abs(x[0]);
    };

    const LbfgsResult found = minimise_lbfgs(kinked, Eigen::VectorXd::Zero(1), {});

    EXPECT_FALSE(found.converged);
    EXPECT_NE(found.reason.find("kink"), std::string::npos) << found.reason;
}

}  // namespace
}  // namespace palpate

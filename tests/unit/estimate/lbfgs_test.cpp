// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/lbfgs.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

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

TEST(Lbfgs, BeginsAnewWhereAKinkStoppedItAndSaysSoWhereThatDoesNotHelp) {
    // Steps beyond 1 find nothing lower, though the gradient promises it.
    int calls = 0;
    const auto kinked = [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        ++calls;
        gradient = Eigen::VectorXd::Constant(1, -1);
        return 1 + std::abs(x[0]);
    };

    const LbfgsResult found = minimise_lbfgs(kinked, Eigen::VectorXd::Constant(1, -3), {});
    const int of_both = calls;
    calls = 0;
    minimise_lbfgs(kinked, found.x, {});

    EXPECT_FALSE(found.converged);
    EXPECT_NE(found.reason.find("kink"), std::string::npos) << found.reason;
    EXPECT_LT(found.value, 4);
    EXPECT_GE(of_both, 2 * calls);
    LbfgsOptions few;
    few.max_evaluations = 1;
    EXPECT_FALSE(minimise_lbfgs(kinked, Eigen::VectorXd::Constant(1, -3), few).converged);
}

/// A bowl around (1, 2) whose `bad_call`-th value, and with `for_ever` each later one, is `bad`.
DifferentiableFunction faulty_bowl(int bad_call, double bad, bool for_ever, bool bad_gradient) {
    auto calls = std::make_shared<int>(0);
    return [=](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        ++*calls;
        const bool now = *calls == bad_call || (for_ever && *calls > bad_call);
        gradient = Eigen::Vector2d(2 * (x[0] - 1), 20 * (x[1] - 2));
        if (now && bad_gradient) gradient[1] = bad;
        const double value = std::pow(x[0] - 1, 2) + 10 * std::pow(x[1] - 2, 2);
        return now && !bad_gradient ? bad : value;
    };
}

TEST(Lbfgs, EndsInAFinitePointWhateverCallIsNotFinite) {
    LbfgsOptions options;
    options.lower = Eigen::Vector2d(-5, -5);
    options.upper = Eigen::Vector2d(5, 5);
    options.relative_tolerance = 1e-10;
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {std::nan(""), infinity, -infinity})
        for (int call = 1; call <= 20; ++call)
            for (const bool for_ever : {false, true})
                for (const bool bad_gradient : {false, true}) {
                    const auto bowl = faulty_bowl(call, bad, for_ever, bad_gradient);
                    SCOPED_TRACE(fmt::format("{} at call {}, for ever {}, gradient {}", bad, call,
                                             for_ever, bad_gradient));
                    if (for_ever && call == 1) {
                        EXPECT_THROW(minimise_lbfgs(bowl, Eigen::Vector2d(-4, -3), options), Error);
                        continue;
                    }

                    const LbfgsResult found =
                        minimise_lbfgs(bowl, Eigen::Vector2d(-4, -3), options);

                    EXPECT_TRUE(found.x.allFinite() && std::isfinite(found.value));
                    EXPECT_TRUE(std::isfinite(found.gradient));
                    EXPECT_LE(found.value, 275 + 1e-9);  // that of the start
                    if (!for_ever) {
                        EXPECT_LT((found.x - Eigen::Vector2d(1, 2)).norm(), 1e-3);
                    }
                    if (found.converged) {
                        EXPECT_LT(found.gradient, 1e-3);
                    }
                }
}

TEST(Lbfgs, OfAConstantIsDoneAtOnce) {
    const auto constant = [](const Eigen::VectorXd&, Eigen::VectorXd&) { return 3.0; };

    const LbfgsResult found = minimise_lbfgs(constant, Eigen::Vector2d(1, 1), {});

    EXPECT_EQ(found.value, 3);
    EXPECT_EQ(found.gradient, 0);
    EXPECT_TRUE(found.x == Eigen::Vector2d(1, 1));
}

TEST(Lbfgs, OverStepsEndsInTheLowestThatItSaw) {
    const auto stairs = [](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        gradient = Eigen::Vector2d(1, 1);
        return std::floor(x[0]) + std::floor(x[1]);
    };
    LbfgsOptions options;
    options.lower = Eigen::Vector2d(-3, -3);
    options.upper = Eigen::Vector2d(3, 3);

    const LbfgsResult found = minimise_lbfgs(stairs, Eigen::Vector2d(2.5, 2.5), options);

    EXPECT_LE(found.value, 4);
    EXPECT_TRUE(found.x.allFinite());
}

TEST(Lbfgs, AtBoundsReportsTheProjectedGradient) {
    const auto slope = [](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        gradient = Eigen::VectorXd::Ones(1);
        return x[0];
    };
    LbfgsOptions options;
    options.lower = Eigen::VectorXd::Constant(1, -2);
    options.upper = Eigen::VectorXd::Constant(1, 2);

    for (const double start : {-2.0, 0.0, 2.0}) {
        const LbfgsResult found =
            minimise_lbfgs(slope, Eigen::VectorXd::Constant(1, start), options);
        EXPECT_NEAR(found.x[0], -2, 1e-9);
        EXPECT_NEAR(found.gradient, 0, 1e-9);
        EXPECT_NEAR(found.start_gradient, std::min(1.0, start + 2), 1e-9);
    }
    EXPECT_THROW(minimise_lbfgs(slope, Eigen::VectorXd::Constant(1, 9), options), Error);
    EXPECT_THROW(minimise_lbfgs(slope, Eigen::VectorXd::Constant(1, std::nan("")), options), Error);
}

}  // namespace
}  // namespace palpate

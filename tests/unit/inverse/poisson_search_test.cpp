// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/poisson_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// A paraboloid with its minimum at `best` and ln E = 4 + slope . ratios, noisy as searches are.
RatioEvaluation paraboloid(const Eigen::VectorXd& best, const Eigen::MatrixXd& covariance,
                           double noise = 0) {
    return [=](const Eigen::VectorXd& ratios) {
        const Eigen::VectorXd d = ratios - best;
        RatioTrial trial;
        trial.ratios = ratios;
        trial.objective =
            -800 + 0.5 * d.dot(covariance.inverse() * d) + noise * std::sin(1e4 * ratios.sum());
        trial.theta = Eigen::VectorXd::Constant(1, 4 + 2.0 * ratios[0]);
        return trial;
    };
}

TEST(PoissonSearch, FindsTheBestRatioItsIntervalAndWhatItDoesToTheModulus) {
    const Eigen::MatrixXd variance = Eigen::MatrixXd::Constant(1, 1, 0.02 * 0.02);
    const RatioEvaluation evaluate = paraboloid(Eigen::VectorXd::Constant(1, 0.37), variance, 0.1);
    const RatioPosterior found = search_ratios(evaluate, Eigen::VectorXd::Constant(1, 0.40), {});

    EXPECT_NEAR(found.best.ratios[0], 0.37, 0.008);
    EXPECT_NEAR(std::sqrt(found.covariance(0, 0)), 0.02, 0.002);
    EXPECT_NEAR(found.reach[0][0], 1.96 * 0.02, 0.005);
    EXPECT_NEAR(found.reach[0][1], 1.96 * 0.02, 0.005);
    EXPECT_EQ(found.at_limit[0], RatioLimit::none);
    EXPECT_TRUE(found.converged);
    const RatioScan scan = scan_ratios(evaluate, found, {}).at(0);
    ASSERT_EQ(scan.ratio.size(), 5u);
    EXPECT_NEAR(scan.theta(0, 4) - scan.theta(0, 0), 2.0 * (scan.ratio[4] - scan.ratio[0]), 1e-9);
    EXPECT_LT(found.evaluations, 20);
}

TEST(PoissonSearch, FindsTwoRatiosThatTrade) {
    const Eigen::Vector2d best(0.44, 0.33);
    Eigen::Matrix2d covariance;
    covariance << 4e-4, 2e-4, 2e-4, 4e-4;

    const RatioPosterior found =
        search_ratios(paraboloid(best, covariance), Eigen::Vector2d(0.40, 0.35), {});

    EXPECT_LT((found.best.ratios - best).cwiseAbs().maxCoeff(), 0.005);
    EXPECT_LT((found.covariance - covariance).cwiseAbs().maxCoeff(), 2e-5);
}

TEST(PoissonSearch, ReachesMinimaOfObjectivesThatSteepenTowardsOneHalf) {
    const auto steep = [](double ratio) { return -std::log(1 - 2 * ratio); };
    RatioSearchOptions options;
    options.first_step = 0.08;
    for (const double truth : {0.28, 0.34, 0.40, 0.45, 0.47}) {
        const auto evaluate = [&](const Eigen::VectorXd& ratios) {
            const double z = (steep(ratios[0]) - steep(truth)) / 0.1;
            return RatioTrial{ratios, 0.5 * z * z, Eigen::VectorXd::Zero(1)};
        };
        const RatioPosterior found =
            search_ratios(evaluate, Eigen::VectorXd::Constant(1, 0.40), options);
        EXPECT_LT(found.best.objective, 0.5) << truth;
        EXPECT_LT(std::abs(found.best.ratios[0] - truth), 0.01) << truth;
    }
}

TEST(PoissonSearch, WhatTheImagesDoNotShowReachesPastTheWholeRange) {
    RatioSearchOptions options;
    const double range = options.highest - options.lowest;
    for (const double slope : {0.0, -2.0}) {
        const auto flat = [&](const Eigen::VectorXd& ratios) {
            return RatioTrial{ratios, slope * ratios[0], Eigen::VectorXd::Zero(1)};
        };
        const RatioPosterior found =
            search_ratios(flat, Eigen::VectorXd::Constant(1, 0.40), options);
        EXPECT_GT(found.reach[0][0], 0.75 * range) << slope;
    }
}

TEST(PoissonSearch, AtALimitOnlyTheInsideIsKnown) {
    RatioSearchOptions options;
    const double sd = 0.02, beyond = 0.06;
    const RatioPosterior found =
        search_ratios(paraboloid(Eigen::VectorXd::Constant(1, options.highest + beyond),
                                 Eigen::MatrixXd::Constant(1, 1, sd * sd)),
                      Eigen::VectorXd::Constant(1, 0.40), options);

    EXPECT_NEAR(found.best.ratios[0], options.highest, 1e-9);
    EXPECT_EQ(found.at_limit[0], RatioLimit::highest);
    // (beyond + d)^2 / 2 sd^2 rises by 1.92 over its value at d = 0.
    const double expected = std::sqrt(beyond * beyond + 2 * 1.920729 * sd * sd) - beyond;
    EXPECT_NEAR(found.reach[0][0], expected, 1e-3);
}

TEST(PoissonSearch, StaysInsideTheRangeAndLetsErrorsThrough) {
    RatioSearchOptions options;
    const auto inside = [&](const Eigen::VectorXd& ratios) {
        EXPECT_GE(ratios[0], options.lowest);
        EXPECT_LE(ratios[0], options.highest);
        return RatioTrial{ratios, ratios[0], Eigen::VectorXd::Zero(1)};
    };
    EXPECT_NEAR(search_ratios(inside, Eigen::VectorXd::Constant(1, 0.1), options).best.ratios[0],
                options.lowest, 1e-9);
    const auto broken = [](const Eigen::VectorXd&) -> RatioTrial {
        throw Error(ErrorCode::solve_failed, "broken");
    };
    EXPECT_THROW(search_ratios(broken, Eigen::VectorXd::Constant(1, 0.4), options), Error);
}

TEST(PoissonSearch, AnObjectiveThatIsNoNumberIsAnError) {
    const auto broken = [](const Eigen::VectorXd& ratios) {
        return RatioTrial{ratios, std::nan(""), Eigen::VectorXd::Zero(1)};
    };
    EXPECT_THROW(search_ratios(broken, Eigen::VectorXd::Constant(1, 0.4), {}), Error);
}

TEST(PoissonSearch, TooFewTrialsAreReported) {
    RatioSearchOptions options;
    options.max_evaluations = 4;
    EXPECT_FALSE(search_ratios(paraboloid(Eigen::VectorXd::Constant(1, 0.3),
                                          Eigen::MatrixXd::Constant(1, 1, 1e-4)),
                               Eigen::VectorXd::Constant(1, 0.4), options)
                     .converged);
}

TEST(PoissonSearch, TheModelsOwnErrorWidensAReach) {
    const auto wide = with_ratio_model_error({0.02, 0.0});

    EXPECT_NEAR(wide[0], std::hypot(0.02, 1.96 * ratio_model_sd), 1e-12);
    EXPECT_NEAR(wide[1], 1.96 * ratio_model_sd, 1e-12);
}

}  // namespace
}  // namespace palpate

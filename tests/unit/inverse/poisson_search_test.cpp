// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/poisson_search.hpp"

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
    const RatioPosterior found =
        search_ratios(paraboloid(Eigen::VectorXd::Constant(1, 0.37), variance, 0.1),
                      Eigen::VectorXd::Constant(1, 0.40), {});

    EXPECT_NEAR(found.best.ratios[0], 0.37, 0.008);
    EXPECT_NEAR(std::sqrt(found.covariance(0, 0)), 0.02, 0.002);
    EXPECT_NEAR(found.interval[0][1] - found.interval[0][0], 2 * 1.96 * 0.02, 0.01);
    EXPECT_NEAR(found.theta_slope(0, 0), 2.0, 1e-6);
    EXPECT_LT(found.evaluations, 15);
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

TEST(PoissonSearch, WhatTheImagesDoNotShowTakesTheWholeRange) {
    RatioSearchOptions options;
    const RatioPosterior found = search_ratios(
        paraboloid(Eigen::VectorXd::Constant(1, 0.37), Eigen::MatrixXd::Constant(1, 1, 100.0)),
        Eigen::VectorXd::Constant(1, 0.40), options);

    EXPECT_GT(found.interval[0][1] - found.interval[0][0],
              2.0 / 3.0 * (options.highest - options.lowest));
}

TEST(PoissonSearch, AtALimitTheIntervalIsOneSided) {
    RatioSearchOptions options;
    const double sd = 0.02, beyond = 0.06;
    const RatioPosterior found =
        search_ratios(paraboloid(Eigen::VectorXd::Constant(1, options.highest + beyond),
                                 Eigen::MatrixXd::Constant(1, 1, sd * sd)),
                      Eigen::VectorXd::Constant(1, 0.40), options);

    EXPECT_NEAR(found.best.ratios[0], options.highest, 1e-9);
    EXPECT_EQ(found.interval[0][1], options.highest);
    // (beyond + d)^2 / 2 sd^2 rises by 1.92 over its value at d = 0.
    const double expected = std::sqrt(beyond * beyond + 2 * 1.920729 * sd * sd) - beyond;
    EXPECT_NEAR(options.highest - found.interval[0][0], expected, 1e-3);
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

TEST(PoissonSearch, TheModelsOwnErrorWidensAnIntervalInsideTheRange) {
    const auto wide = with_ratio_model_error({0.38, 0.42}, 0.40, {0.25, 0.41});

    EXPECT_NEAR(wide[0], 0.40 - std::hypot(0.02, 1.96 * ratio_model_sd), 1e-12);
    EXPECT_EQ(wide[1], 0.41);
}

}  // namespace
}  // namespace palpate

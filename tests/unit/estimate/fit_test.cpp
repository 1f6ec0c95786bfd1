// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "host/estimate/identified.hpp"
#include "relaxation_problem.hpp"
#include "solver/base/error.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

using Number = ToyProblem::Number;
using Values = std::vector<Number>;

FitOptions without_discrepancy() {
    FitOptions options;
    options.discrepancy.is_learned = false;
    return options;
}

/// y = a + b t with Gaussian priors on scales of their own.
ToyProblem line(const Eigen::VectorXd& times, const Eigen::VectorXd& measured, double sd) {
    Parameter a = flat_parameter("a", 0), b = flat_parameter("b", 0);
    a.median = 1;
    a.sd = 2;
    b.sd = 0.5;
    return {{a, b}, toy_block(measured, sd), [times](const Values& v, Index row) {
                return v[0] + v[1] * times[row];
            }};
}

TEST(Fit, ALinearProblemHasThePosteriorAndEvidenceOfItsClosedForm) {
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(9, 0, 4);
    Eigen::VectorXd measured = 1.7 + 0.4 * times.array();
    measured[2] += 0.3;
    measured[7] -= 0.4;
    const ToyProblem problem = line(times, measured, 0.3);

    FitOptions options = without_discrepancy();
    options.gauss_newton.gain_tolerance = 1e-16;

    const Fit found = fit(problem, options);
    const Identified known = identify(problem, found, {});

    // y ~ N(J m, sd^2 I + J P J^T)
    Eigen::MatrixXd columns(9, 2);
    columns << Eigen::VectorXd::Ones(9), times;
    const Eigen::Matrix2d prior = Eigen::Vector2d(4, 0.25).asDiagonal();
    const Eigen::Vector2d median(1, 0);
    const Eigen::MatrixXd covariance =
        columns * prior * columns.transpose() + 0.09 * Eigen::MatrixXd::Identity(9, 9);
    const Eigen::VectorXd off = measured - columns * median;
    const Eigen::Vector2d mean = median + prior * columns.transpose() * covariance.inverse() * off;
    const Eigen::Matrix2d posterior =
        prior - prior * columns.transpose() * covariance.inverse() * columns * prior;
    const double evidence = -0.5 * off.dot(covariance.inverse() * off) -
                            0.5 * std::log(covariance.determinant()) -
                            4.5 * std::log(2 * std::numbers::pi);
    EXPECT_LT((found.values - mean).norm(), 1e-8);
    EXPECT_LT((known.covariance - posterior).norm(), 1e-8);
    EXPECT_NEAR(known.log_evidence, evidence, 1e-8);
    EXPECT_FALSE(known.parameters[0].is_profiled);
    EXPECT_NEAR(known.parameters[1].interval[1], mean[1] + 1.959964 * std::sqrt(posterior(1, 1)),
                1e-6);
    EXPECT_NEAR(known.blocks[0].effective_rows, 9, 1e-9);
}

TEST(Fit, OutliersCountLessButDoNotGoUnseen) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(200, 0, 4);
    Eigen::VectorXd measured = 1.7 + 0.4 * times.array();
    for (Index i = 0; i < 200; ++i) measured[i] += 0.1 * normal(random) + (i % 20 == 3 ? 8 : 0);
    const ToyProblem problem = line(times, measured, 0.1);
    FitOptions squares = without_discrepancy();
    squares.noise.huber_sd = std::numeric_limits<double>::infinity();

    const Fit robust = fit(problem, without_discrepancy());
    const Fit plain = fit(problem, squares);
    const Identified known = identify(problem, robust, {});

    EXPECT_NEAR(robust.values[0], 1.7, 0.06);
    EXPECT_NEAR(robust.values[1], 0.4, 0.03);
    EXPECT_GT(std::abs(plain.values[0] - 1.7), 0.25);
    EXPECT_GE(known.blocks[0].num_outlier, 10);
    EXPECT_LE(known.blocks[0].num_outlier, 14);
}

TEST(Fit, OutliersAreNotTakenForADiscrepancy) {
    std::mt19937 random(12);
    std::normal_distribution<double> normal;
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(120, 0.25, 30);
    ToyProblem problem = relaxation_problem(times, 0.2);
    const Eigen::VectorXd truth = starts_of(problem.parameters());
    problem.data().measured =
        problem.predict(truth, PredictedColumns::none, nullptr).prediction->blocks[0].predicted;
    for (Index i = 0; i < 120; ++i)
        problem.data().measured[i] += 0.2 * normal(random) + (i % 20 == 7 ? 10 : 0);

    const Fit found = fit(problem, {});

    EXPECT_LT(found.noise->discrepancy(0).amplitude, 0.5);
    EXPECT_LT((found.transformed - to_transformed(problem.parameters(), truth)).norm(), 0.3);
}

TEST(Fit, AFieldIsBoundedByWhatTheBestValuesLeave) {
    // y = t +- 0.2; at a = 2 the residuals are far larger
    DataBlock block = toy_block(Eigen::VectorXd::Zero(50), 0.1);
    block.time_s = Eigen::VectorXd::LinSpaced(50, 0.1, 5);
    for (Index i = 0; i < 50; ++i) block.measured[i] = block.time_s[i] + (i % 2 == 0 ? 0.2 : -0.2);
    const ToyProblem problem{
        {log_parameter("a", 2, 2, 10)}, block, [times = block.time_s](const Values& v, Index row) {
            return v[0] * times[row];
        }};
    const auto prediction =
        problem.predict(Eigen::VectorXd::Constant(1, 2), PredictedColumns::wanted, nullptr)
            .prediction;
    NoiseModel noise(prediction->blocks, {});
    noise.set_discrepancy(0, {5, 1, 1});

    const DiscrepancyRange range =
        discrepancy_ranges(problem.parameters(), *prediction, noise).front();

    EXPECT_NEAR(range.amplitude[1], 3 * 0.2, 0.02);
    EXPECT_LE(range.typical_amplitude, range.amplitude[1]);
}

TEST(Fit, TheQuadraticKnowsTheEndOfASearchThatStoppedBeforeIt) {
    // y = a t, linear: the first linearisation has the minimum
    DataBlock block = toy_block(Eigen::VectorXd::LinSpaced(20, 0.1, 2), 0.1);
    const ToyProblem problem{{flat_parameter("a", 0.5)}, block, [](const Values& v, Index row) {
                                 return v[0] * 0.1 * static_cast<double>(row + 1);
                             }};
    FitOptions options;
    options.discrepancy.is_learned = false;
    options.gauss_newton.gain_tolerance = 1e6;  // ends at the start

    const Fit found = fit(problem, options);

    EXPECT_EQ(found.values[0], 0.5);
    EXPECT_NEAR(quadratic_minimum(problem.parameters(), found, 1e6)[0], 1, 1e-9);
    EXPECT_EQ(quadratic_minimum(problem.parameters(), found, 1)[0], 0.5);  // it would gain more
}

/// A spring under a known force, which tears where it is softer than 1.
ToyProblem spring() {
    return {{log_parameter("stiffness", 8, 3, 1)},
            toy_block(Eigen::VectorXd::Constant(5, 10.0 / 1.2), 0.05),
            [](const Values& v, Index) { return 10.0 / v[0]; }};
}

TEST(Fit, PredictionsThatFailAreRejectedSteps) {
    ToyProblem problem = spring();
    problem.fails = [](const Eigen::VectorXd& values) { return values[0] < 1.19; };

    const Fit found = fit(problem, without_discrepancy());

    EXPECT_EQ(found.ending, Ending::converged);
    EXPECT_NEAR(found.values[0], 1.2, 0.01);
    EXPECT_GE(problem.num_warm, 3);
}

TEST(Fit, AStartWithoutPredictionIsReplacedAndNoneIsAnError) {
    ToyProblem problem = spring();
    problem.mutable_parameters()[0].start = 0.5;
    problem.fails = [](const Eigen::VectorXd& values) { return values[0] < 1; };
    const Fit found = fit(problem, without_discrepancy());
    EXPECT_EQ(found.start_note, "the priors' medians");
    EXPECT_NEAR(found.values[0], 1.2, 0.01);

    // An earlier prediction is nearer than the medians.
    FitOptions options = without_discrepancy();
    options.warm = found.prediction;
    EXPECT_EQ(fit(problem, options).start_note, "that of an earlier prediction");

    problem.fails = [](const Eigen::VectorXd&) { return true; };
    try {
        fit(problem, without_discrepancy());
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::solve_failed);
        EXPECT_NE(std::string(error.what()).find("no equilibrium"), std::string::npos);
    }
}

TEST(Fit, StepsAreAtMostAFactorOfTwo) {
    ToyProblem problem = spring();
    problem.mutable_parameters()[0].start = 100;
    std::vector<double> visited;
    problem.fails = [&](const Eigen::VectorXd& values) {
        visited.push_back(std::log(values[0]));
        return false;
    };

    fit(problem, without_discrepancy());

    for (std::size_t k = 1; k < visited.size(); ++k)
        EXPECT_LE(std::abs(visited[k] - visited[k - 1]), 0.7 + 1e-12);
}

TEST(Fit, AKinkThatNoStepLeavesIsTheEndOfASearch) {
    // Lowest at 2, with slopes on both sides that promise far more than any step gains.
    DataBlock data = toy_block(Eigen::VectorXd::Zero(1), 1);
    data.is_robust = false;
    const ToyProblem problem({flat_parameter("k", 3)}, data, [](const auto& v, Index) {
        return v[0].real() > 2 ? 5.0 + (v[0] - 2.0) : 5.0 + 3.0 * (2.0 - v[0]);
    });

    const Fit found = fit(problem, without_discrepancy());

    EXPECT_NEAR(found.values[0], 2, 0.1);
    EXPECT_EQ(found.ending, Ending::stalled);
    EXPECT_LT(found.num_step, 30);
}

TEST(Fit, WhatIsHeldStaysAtTheStart) {
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(9, 0, 4);
    const Eigen::VectorXd measured = 1.7 + 0.4 * times.array();
    const ToyProblem problem = line(times, measured, 0.3);
    FitOptions options = without_discrepancy();
    options.start = Eigen::Vector2d(0.5, 0.1);
    options.held = {1};
    const Fit found = fit(problem, options);
    EXPECT_EQ(found.values[1], 0.1);
    EXPECT_NEAR(found.values[0], 1.7 + 0.3 * 2, 0.01);  // the mean of what is left
    options.held.clear();
    EXPECT_NEAR(fit(problem, options).values[1], 0.4, 0.03);
}

TEST(Fit, HardEndsHold) {
    ToyProblem problem = spring();
    problem.mutable_parameters()[0].lowest = 1.5;

    const Fit found = fit(problem, without_discrepancy());

    EXPECT_EQ(found.ending, Ending::converged);
    EXPECT_DOUBLE_EQ(found.values[0], 1.5);
}

TEST(Fit, AllMethodsFindTheSameMinimum) {
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(60, 0.25, 30);
    ToyProblem problem = relaxation_problem(times, 0.2);
    Eigen::VectorXd truth = starts_of(problem.parameters());
    truth[0] = 130;
    truth[4] = 7;
    problem.data().measured =
        problem.predict(truth, PredictedColumns::none, nullptr).prediction->blocks[0].predicted;
    FitOptions options = without_discrepancy();
    const Fit map = fit(problem, options);
    for (const FitMethod method : {FitMethod::simplex, FitMethod::bobyqa}) {
        options.method = method;
        options.max_evaluations = 5000;

        const Fit other = fit(problem, options);

        EXPECT_NEAR(other.objective, map.objective, 0.1) << name_of(method);
        EXPECT_GT(other.num_prediction, 5 * map.num_prediction) << name_of(method);
        EXPECT_EQ(fit_method_of(name_of(method)), method);
    }
    EXPECT_THROW(fit_method_of("genetic"), Error);
}

TEST(Fit, CanBeCancelled) {
    const ToyProblem problem = spring();
    const ProgressSink cancel = [](const Progress&) {
        throw Error(ErrorCode::cancelled, "enough");
    };

    EXPECT_THROW(fit(problem, {}, cancel), Error);
}

TEST(Fit, DataThatMakeNoSenseAreRefusedByBlockAndRow) {
    ToyProblem problem = spring();
    problem.data().sd[3] = 0;
    try {
        fit(problem, {});
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("row 4"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace palpate

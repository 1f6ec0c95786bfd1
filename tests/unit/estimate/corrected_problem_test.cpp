// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/corrected_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/estimate/fit.hpp"
#include "solver/base/error.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

using Values = std::vector<ToyProblem::Number>;

constexpr double rate = 0.7, amplitude = 2;

/// y = a exp(-b t), of a model that is `off` too high and decays `off` too fast.
ToyProblem decay(double off) {
    Eigen::VectorXd measured(12);
    for (Index i = 0; i < 12; ++i) measured[i] = amplitude * std::exp(-rate * 0.25 * i);
    return {{log_parameter("a", 1.5, 1.5, 1), log_parameter("b", 0.5, 0.5, 1)},
            toy_block(measured, 0.001),
            [off](const Values& v, Index i) {
                return (1 + off) * v[0] * std::exp(-(1 + off) * v[1] * 0.25 * double(i));
            }};
}

double error_of(const Fit& found) {
    return std::hypot(std::log(found.values[0] / amplitude), std::log(found.values[1] / rate));
}

TEST(CorrectedProblem, SaysWhatTheExactModelSaysAtOnePlaceAndFitsFarBetterThanTheCheapOne) {
    const ToyProblem exact = decay(0), cheap = decay(0.05);
    FitOptions options;
    options.discrepancy.is_learned = false;
    const Fit rough = fit(cheap, options);
    const auto exact_at =
        checked_prediction(exact, rough.values, PredictedColumns::none, nullptr).prediction;
    const auto cheap_at =
        checked_prediction(cheap, rough.values, PredictedColumns::wanted, nullptr).prediction;
    const CorrectedProblem corrected(cheap, *exact_at, cheap_at);

    const auto same = corrected.predict(rough.values, PredictedColumns::wanted, nullptr).prediction;
    EXPECT_LT((same->blocks[0].predicted - exact_at->blocks[0].predicted).norm(), 1e-14);
    EXPECT_EQ(same->blocks[0].columns, cheap_at->blocks[0].columns);
    const auto of_cheap = CorrectedProblem::cheap_of(*same);
    ASSERT_TRUE(of_cheap);
    EXPECT_EQ(of_cheap->blocks[0].predicted, cheap_at->blocks[0].predicted);
    EXPECT_FALSE(CorrectedProblem::cheap_of(*exact_at));

    options.start = rough.values;
    const Fit near = fit(corrected, options);
    // the distance times what the columns have wrong: a twentieth
    EXPECT_GT(error_of(rough), 0.05);
    EXPECT_LT(error_of(near), 0.1 * error_of(rough));
}

TEST(CorrectedProblem, RefusesPredictionsOfOtherValuesOrRows) {
    const ToyProblem exact = decay(0), cheap = decay(0.05);
    const auto at = [](const ToyProblem& problem, double a) {
        return checked_prediction(problem, Eigen::Vector2d(a, 0.5), PredictedColumns::none, nullptr)
            .prediction;
    };
    EXPECT_THROW(CorrectedProblem(cheap, *at(exact, 1.5), at(cheap, 1.6)), Error);
    ToyProblem shorter = decay(0);
    shorter.data() = toy_block(Eigen::VectorXd::Ones(5), 0.1);
    EXPECT_THROW(CorrectedProblem(cheap, *at(shorter, 1.5), at(cheap, 1.5)), Error);
}

TEST(CorrectedProblem, FailsWhereTheCheapModelFails) {
    const ToyProblem exact = decay(0);
    ToyProblem cheap = decay(0.05);
    cheap.fails = [](const Eigen::VectorXd& values) { return values[0] > 3; };
    const Eigen::Vector2d at(1.5, 0.5);
    const auto predict = [&](const ToyProblem& problem) {
        return checked_prediction(problem, at, PredictedColumns::none, nullptr).prediction;
    };
    const CorrectedProblem corrected(cheap, *predict(exact), predict(cheap));
    const PredictionAttempt made =
        corrected.predict(Eigen::Vector2d(4, 0.5), PredictedColumns::none, nullptr);
    EXPECT_FALSE(made.prediction);
    EXPECT_EQ(made.failure, "no equilibrium");
}

}  // namespace
}  // namespace palpate

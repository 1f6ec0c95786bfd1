// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/identified.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "relaxation_problem.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

using Number = ToyProblem::Number;
using Values = std::vector<Number>;

FitOptions held() {
    FitOptions options;
    options.discrepancy.is_learned = false;
    options.gauss_newton.gain_tolerance = 1e-6;
    return options;
}

/// Displacement F / k of a spring of unknown stiffness k, F = 10: minus the log posterior of ln k
/// is skewed, but that of the displacement is not.
ToyProblem spring(double measured, double sd) {
    return {{log_parameter("stiffness", 5, 5, 50)},
            toy_block(Eigen::VectorXd::Constant(1, measured), sd),
            [](const Values& v, Index) { return 10.0 / v[0]; }};
}

TEST(Identified, ASkewedPosteriorHasTheIntervalOfItsProfile) {
    const ToyProblem problem = spring(2.0, 0.4);

    const Identified known = identify(problem, fit(problem, held()), {});

    // 10 / k = 2 +- 1.96 0.4
    const IdentifiedParameter& stiffness = known.parameters[0];
    EXPECT_TRUE(stiffness.is_profiled);
    EXPECT_NEAR(stiffness.interval[0], 10 / (2 + 0.784), 0.03);
    EXPECT_NEAR(stiffness.interval[1], 10 / (2 - 0.784), 0.12);
    EXPECT_EQ(stiffness.judgement.verdict, Verdict::weak);
}

TEST(Identified, EndsLookedForSideBySideAreTheSame) {
    const ToyProblem problem = spring(2.0, 0.4);
    const Fit found = fit(problem, held());
    IdentifyOptions several;
    several.jobs = 3;

    const Identified known = identify(problem, found, {});
    const Identified same = identify(problem, found, several);

    ASSERT_TRUE(known.parameters[0].is_profiled);
    EXPECT_EQ(same.parameters[0].interval, known.parameters[0].interval);
    EXPECT_EQ(same.num_prediction, known.num_prediction);
}

TEST(Identified, APreciseSpringIsRecoveredWithoutAProfile) {
    const ToyProblem problem = spring(2.0, 0.02);

    const Identified known = identify(problem, fit(problem, held()), {});

    EXPECT_FALSE(known.parameters[0].is_profiled);
    EXPECT_EQ(known.parameters[0].judgement.verdict, Verdict::recovered);
    // Both sides of the ridge; far ends are excluded by the interval itself.
    EXPECT_EQ(known.num_prediction, 2);
}

TEST(Identified, ANuisanceHasAQuadraticIntervalWithinItsRange) {
    ToyProblem problem = spring(2.0, 0.4);
    Parameter& stiffness = problem.mutable_parameters()[0];
    stiffness.is_nuisance = true;
    stiffness.lowest = 4;

    const Identified known = identify(problem, fit(problem, held()), {});

    const IdentifiedParameter& found = known.parameters[0];
    EXPECT_FALSE(found.is_profiled);
    EXPECT_EQ(known.num_prediction, 0);
    EXPECT_DOUBLE_EQ(found.interval[0], 4);
    EXPECT_NEAR(found.interval[1], found.value * std::exp(1.96 * found.sd), 1e-2);
}

TEST(Identified, ASpringThatHardlyMovesHasALowerBoundOnly) {
    ToyProblem problem = spring(0.02, 0.05);
    problem.mutable_parameters()[0].median = 200;
    problem.mutable_parameters()[0].start = 200;
    problem.mutable_parameters()[0].sd = 2.5;

    const Identified known = identify(problem, fit(problem, held()), {});

    const IdentifiedParameter& stiffness = known.parameters[0];
    EXPECT_EQ(stiffness.judgement.verdict, Verdict::weak);
    EXPECT_NE(stiffness.judgement.reason.find("only a lower bound"), std::string::npos)
        << stiffness.judgement.reason;
    EXPECT_GT(stiffness.interval[1], 200 * std::exp(1.9 * 2.5));
}

TEST(Identified, AnEndThatIsOnlyGivenUpEarlyIsNotExcluded) {
    ToyProblem problem = spring(0.02, 0.05);
    problem.mutable_parameters()[0].median = 200;
    problem.mutable_parameters()[0].start = 200;
    problem.mutable_parameters()[0].sd = 2.5;
    problem.fails_warm = [](const Eigen::VectorXd& values) { return values[0] > 1e6; };

    const Identified known = identify(problem, fit(problem, held()), {});

    const Judgement& judgement = known.parameters[0].judgement;
    EXPECT_NE(judgement.reason.find("only a lower bound"), std::string::npos) << judgement.reason;
}

TEST(Identified, WhatDataDoNotTouchKeepsThePriorsInterval) {
    ToyProblem problem = spring(2.0, 0.02);
    problem.mutable_parameters().push_back(log_parameter("other", 3, 3, 0.5));

    const Identified known = identify(problem, fit(problem, held()), {});

    EXPECT_EQ(known.parameters[1].judgement.verdict, Verdict::not_identifiable);
    EXPECT_NEAR(known.parameters[1].interval[1], 3 * std::exp(1.96 * 0.5), 1e-9);
    EXPECT_NEAR(known.num_determined, 1, 1e-3);
    EXPECT_NEAR(known.singular_values[1], 0, 1e-9);
}

TEST(Identified, CombinationsArePutInWords) {
    // Only mu sqrt(gamma) is seen.
    const ToyProblem problem({log_parameter("mu", 2, 2, 1.5), log_parameter("gamma", 4, 4, 1.5)},
                             toy_block(Eigen::VectorXd::Constant(4, 4.2), 0.04),
                             [](const Values& v, Index) { return v[0] * std::sqrt(v[1]); });

    const Identified known = identify(problem, fit(problem, held()), {});

    EXPECT_EQ(known.best_known.words, "mu * gamma^0.5 is known to 0.94 %");
    EXPECT_NE(known.weakest.words.find("gamma / mu^0.5 is known only to a factor of"),
              std::string::npos)
        << known.weakest.words;
    EXPECT_EQ(known.parameters[0].judgement.verdict, Verdict::weak);
    EXPECT_EQ(known.parameters[0].partner, 1);
    EXPECT_LT(known.parameters[0].partner_correlation, -0.99);
    EXPECT_NE(known.parameters[0].judgement.reason.find("trades with gamma"), std::string::npos);
}

TEST(Identified, AFactorOfUnknownScaleHasAFlatPrior) {
    Parameter offset = flat_parameter("offset", 1);
    const ToyProblem problem({offset}, toy_block(Eigen::VectorXd::Constant(4, 4.0), 0.2),
                             [](const Values& v, Index) { return v[0]; });

    const Identified known = identify(problem, fit(problem, held()), {});

    EXPECT_NEAR(known.parameters[0].interval[0], 4 - 0.196, 1e-4);
    EXPECT_EQ(known.parameters[0].judgement.verdict, Verdict::recovered);
}

TEST(Identified, TheRightModelHasTheHigherEvidence) {
    const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(60, 0.25, 30);
    ToyProblem two = relaxation_problem(times, 0.5);
    two.data().measured = two.predict(starts_of(two.parameters()), PredictedColumns::none, nullptr)
                              .prediction->blocks[0]
                              .predicted;
    for (Index i = 0; i < 60; ++i) two.data().measured[i] += 0.5 * std::sin(12.9898 * i * i);
    const std::vector<Parameter> all = relaxation_parameters();
    const ToyProblem one({all[0], all[1], all[4]}, two.data(), [times](const Values& v, Index row) {
        return v[0] * (1.0 - v[1] * (1.0 - std::exp(-times[row] / v[2])));
    });

    const Identified of_two = identify(two, fit(two, {}), {});
    const Identified of_one = identify(one, fit(one, {}), {});

    EXPECT_GT(of_two.log_evidence, of_one.log_evidence + 5);
    EXPECT_LT(of_two.bic, of_one.bic);
    EXPECT_GT(of_one.blocks[0].discrepancy.amplitude, 3 * of_two.blocks[0].discrepancy.amplitude);
}

}  // namespace
}  // namespace palpate

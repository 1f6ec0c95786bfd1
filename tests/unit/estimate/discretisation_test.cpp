// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/discretisation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

using Number = ToyProblem::Number;

/// y_i = k (1 + error) x_i, k looked for; a coarse model has the error e h^2.
ToyProblem stretched(double error, double measured_factor) {
    Eigen::VectorXd measured(5);
    for (Index i = 0; i < 5; ++i) measured[i] = measured_factor * (i + 1);
    DataBlock block;
    block.name = "force";
    block.measured = measured;
    block.sd = Eigen::VectorXd::Constant(5, 0.01);
    block.has_discrepancy = false;
    return {
        {log_parameter("k", 1, 1, 1.5)}, block, [error](const std::vector<Number>& v, Index row) {
            return v[0] * (1 + error) * Number(row + 1);
        }};
}

TEST(Discretisation, AnErrorOfSecondOrderIsTakenOutAndLeavesItsShareInTheInterval) {
    constexpr double error = 0.04, truth = 2;
    const ToyProblem coarse = stretched(error, truth), fine = stretched(error / 4, truth);
    FitOptions options;
    options.discrepancy.is_learned = false;
    options.gauss_newton.gain_tolerance = 1e-10;
    const Fit found = fit(coarse, options);
    Identified known = identify(coarse, found, {});
    const IdentifiedParameter before = known.parameters[0];
    const auto finer = fine.predict(found.values, PredictedColumns::none, nullptr).prediction;

    const Eigen::VectorXd shift = shift_by_discretisation(coarse.parameters(), found, *finer);
    // From k (1 + e) = 2 to k (1 + e / 4) = 2.
    EXPECT_NEAR(shift[0], std::log((1 + error) / (1 + error / 4)), 0.03 * shift[0]);
    correct_for_discretisation({shift}, found, known);

    const IdentifiedParameter& after = known.parameters[0];
    EXPECT_LT(before.interval[1], truth);
    EXPECT_NEAR(after.value, truth, 0.002);
    EXPECT_NEAR(after.discretisation_shift, 4.0 / 3.0 * shift[0], 1e-12);
    // A shift of many sd: the correction is a guess.
    ASSERT_GT(after.discretisation_shift, 3 * before.sd);
    EXPECT_NEAR(after.discretisation_sd, shift[0], 1e-12);
    const double half_before = std::log(before.interval[1] / before.value);
    const double half_after = std::log(after.interval[1] / after.value);
    EXPECT_NEAR(half_after, std::hypot(half_before, 1.96 * shift[0]), 1e-4);
    EXPECT_LT(after.interval[0], truth);
    EXPECT_GT(after.interval[1], truth);
    const Eigen::VectorXd small = Eigen::VectorXd::Constant(1, 0.5 * before.sd);
    Identified other = identify(coarse, found, {});
    correct_for_discretisation({small}, found, other);
    EXPECT_NEAR(other.parameters[0].discretisation_sd, small[0] / 3, 1e-12);
}

TEST(Discretisation, ShiftsThatHideEachOtherAreNoLessUnknown) {
    const ToyProblem problem = stretched(0, 2);
    const Fit found = fit(problem, {});
    Identified known = identify(problem, found, {});
    const double much = 10 * known.parameters[0].sd;
    correct_for_discretisation(
        {Eigen::VectorXd::Constant(1, much), Eigen::VectorXd::Constant(1, -much)}, found, known);
    EXPECT_NEAR(known.parameters[0].discretisation_shift, 0, 1e-12);
    EXPECT_NEAR(known.parameters[0].discretisation_sd, std::sqrt(2.0) * much, 1e-12);

    // and of one sign their sum counts
    Identified same = identify(problem, found, {});
    const Eigen::VectorXd one = Eigen::VectorXd::Constant(1, 1.2 * same.parameters[0].sd);
    correct_for_discretisation({one, one}, found, same);
    EXPECT_NEAR(same.parameters[0].discretisation_sd, std::sqrt(2.0) * one[0], 1e-12);
}

TEST(Discretisation, AnIntervalThatItWidensBeyondAFactorOfTwoIsRecoveredNoLonger) {
    const ToyProblem problem = stretched(0, 2);
    const Fit found = fit(problem, {});
    Identified known = identify(problem, found, {});
    ASSERT_EQ(known.parameters[0].judgement.verdict, Verdict::recovered);
    Identified nearly = known;
    correct_for_discretisation({Eigen::VectorXd::Constant(1, 0.1)}, found, nearly);
    EXPECT_EQ(nearly.parameters[0].judgement.verdict, Verdict::recovered);
    correct_for_discretisation({Eigen::VectorXd::Constant(1, 0.9)}, found, known);
    const auto [low, high] = known.parameters[0].interval;
    ASSERT_GT(high / low, 2);
    EXPECT_EQ(known.parameters[0].judgement.verdict, Verdict::weak);
}

TEST(Discretisation, ANumberThatIsNotIdentifiableStaysInItsInterval) {
    const ToyProblem problem = stretched(0, 2);
    const Fit found = fit(problem, {});
    Identified known = identify(problem, found, {});
    known.parameters[0].judgement.verdict = Verdict::not_identifiable;
    const IdentifiedParameter before = known.parameters[0];
    correct_for_discretisation({Eigen::VectorXd::Constant(1, 2)}, found, known);
    EXPECT_EQ(known.parameters[0].value, before.value);
    EXPECT_EQ(known.parameters[0].interval, before.interval);
    EXPECT_EQ(known.parameters[0].discretisation_shift, 0);
}

TEST(Discretisation, WhatElseAModelHasWrongWidensLogarithmsAloneAndNoNuisance) {
    const ToyProblem problem = stretched(0, 2);
    const Fit found = fit(problem, {});
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(1);
    Identified known = identify(problem, found, {}), nuisance = known;
    const IdentifiedParameter before = known.parameters[0];
    nuisance.parameters[0].parameter.is_nuisance = true;
    correct_for_discretisation({nothing}, found, known, Eigen::VectorXd::Constant(1, 0.03));
    correct_for_discretisation({nothing}, found, nuisance, Eigen::VectorXd::Constant(1, 0.03));
    const double half_before = std::log(before.interval[1] / before.value);
    EXPECT_NEAR(std::log(known.parameters[0].interval[1] / before.value),
                std::hypot(half_before, 1.96 * 0.03), 1e-4);
    EXPECT_EQ(nuisance.parameters[0].interval, before.interval);
}

TEST(Discretisation, WhatBothOfAPairHaveWrongDoesNotMoveValues) {
    constexpr double error = 0.04, in_both = 0.003;
    const ToyProblem coarse = stretched(error, 2);
    const Fit found = fit(coarse, {});
    const auto with = [&](double more, double of) {
        return stretched(of + more, 2)
            .predict(found.values, PredictedColumns::none, nullptr)
            .prediction;
    };

    const Eigen::VectorXd alone =
        shift_by_discretisation(coarse.parameters(), found, *with(0, error / 4));
    const Eigen::VectorXd pair = shift_by_discretisation(
        coarse.parameters(), found, *with(in_both, error / 4), *with(in_both, error));

    EXPECT_GT(alone[0], 0.02);
    EXPECT_NEAR(pair[0], alone[0], 1e-9);
}

TEST(Discretisation, RowsThatDoNotFitAreRefused) {
    const ToyProblem problem = stretched(0, 2);
    const Fit found = fit(problem, {});
    Prediction other;
    EXPECT_THROW(shift_by_discretisation(problem.parameters(), found, other), Error);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/estimate/discretisation.hpp"
#include "host/estimate/identified.hpp"
#include "toy_problem.hpp"

// Parameters whose error counts although the data do not change them.
namespace palpate {
namespace {

using Number = ToyProblem::Number;
using Values = std::vector<Number>;

constexpr double noise = 0.3, offset_sd = 0.5;  // no row is an outlier

Parameter held_offset() {
    Parameter offset = flat_parameter("offset", 1);
    offset.sd = offset_sd;
    offset.is_nuisance = offset.is_held = true;
    return offset;
}

/// y_i = slope x_i + offset with x = 1, 2, 3, 4; the truth is slope 2 and offset 1.8, and the data
/// contradict what was told of the offset, 1 +- 0.5.
ToyProblem line(double noise_sd = noise) {
    Eigen::VectorXd measured(4);
    for (Index i = 0; i < 4; ++i) measured[i] = 2.0 * double(i + 1) + 1.8;
    DataBlock block = toy_block(measured, noise_sd);
    block.has_discrepancy = false;
    return {{flat_parameter("slope", 1), held_offset()}, block, [](const Values& v, Index row) {
                return v[0] * Number(double(row + 1)) + v[1];
            }};
}

FitOptions exact() {
    FitOptions options;
    options.discrepancy.is_learned = false;
    options.gauss_newton.gain_tolerance = 1e-10;
    return options;
}

TEST(HeldParameter, StaysAndItsErrorJoinsThatOfTheOthers) {
    const ToyProblem problem = line();
    const Fit found = fit(problem, exact());

    // slope = sum x (y - 1) / sum x^2, and d slope / d offset = -sum x / sum x^2
    EXPECT_EQ(found.values[1], 1);
    EXPECT_NEAR(found.values[0], 2 + 0.8 * 10 / 30, 1e-8);
    const Identified known = identify(problem, found, {});
    const double alone = noise / std::sqrt(30.0), through_offset = offset_sd * 10 / 30;
    EXPECT_NEAR(known.parameters[0].sd, std::hypot(alone, through_offset), 1e-9);
    EXPECT_NEAR(known.parameters[1].sd, offset_sd, 1e-9);
    EXPECT_NEAR(known.covariance(0, 1), -offset_sd * offset_sd * 10 / 30, 1e-9);
    EXPECT_LT(known.parameters[0].interval[0], 2);

    // looked for, it would be found
    ToyProblem free = line();
    free.mutable_parameters()[1].is_held = false;
    EXPECT_GT(fit(free, exact()).values[1], 1.3);
}

TEST(HeldParameter, WidensProfilesToo) {
    // 10 / k + offset is measured: k is skew, and known worse for the offset
    const auto spring = [](double sd_of_offset) {
        ToyProblem problem{{log_parameter("stiffness", 5, 5, 50), held_offset()},
                           toy_block(Eigen::VectorXd::Constant(1, 3.0), 0.4),
                           [](const Values& v, Index) { return 10.0 / v[0] + v[1]; }};
        problem.mutable_parameters()[1].sd = sd_of_offset;
        return problem;
    };
    const auto stiffness_of = [&](double sd_of_offset) {
        const ToyProblem problem = spring(sd_of_offset);
        return identify(problem, fit(problem, exact()), {}).parameters[0];
    };
    const IdentifiedParameter sure = stiffness_of(1e-6), unsure = stiffness_of(0.4);

    ASSERT_TRUE(sure.is_profiled && unsure.is_profiled);
    EXPECT_NEAR(sure.interval[1], 10 / (2 - 0.784), 0.12);
    for (const int end : {0, 1})
        EXPECT_NEAR(std::log(unsure.interval[end] / 5) / std::log(sure.interval[end] / 5),
                    std::sqrt(2.0), 0.02);
}

TEST(HeldParameter, IsNotMovedByAFinerModel) {
    const ToyProblem problem = line();
    const Fit found = fit(problem, exact());
    Prediction finer = *found.prediction;
    finer.blocks[0].predicted.array() += 0.3;

    const Eigen::VectorXd shift = shift_by_discretisation(problem.parameters(), found, finer);

    EXPECT_NEAR(shift[1], 0, 1e-12);
    EXPECT_NEAR(shift[0], -0.3 * 10 / 30, 1e-9);
}

TEST(HeldParameter, IsTheSameForEveryMethodAndEveryStart) {
    const ToyProblem problem = line();
    for (const FitMethod method : {FitMethod::simplex, FitMethod::bobyqa}) {
        FitOptions options = exact();
        options.method = method;
        const Fit found = fit(problem, options);
        EXPECT_EQ(found.values[1], 1) << name_of(method);
        EXPECT_NEAR(found.values[0], 2 + 0.8 * 10 / 30, 1e-3) << name_of(method);
    }
    std::mt19937 random(3);
    for (int draw = 0; draw < 5; ++draw)
        EXPECT_EQ(draw_from_priors(problem.parameters(), random)[1], 1);
}

TEST(HeldParameter, DoesNotSwallowWhatTheModelMisses) {
    // an offset that the data show all too well must not pass for a discrepancy that is explained
    const ToyProblem problem = line(0.01);
    ToyProblem learning = problem;
    learning.data().has_discrepancy = true;
    const Fit found = fit(learning, {});
    EXPECT_EQ(found.values[1], 1);
    EXPECT_GT(found.noise->discrepancy(0).amplitude, 0.05);
}

TEST(Identified, ANarrowPosteriorIsNotFollowedWhereMoreIsAddedAnyway) {
    const ToyProblem problem{{log_parameter("stiffness", 5, 5, 50)},
                             toy_block(Eigen::VectorXd::Constant(1, 2.0), 0.4),
                             [](const Values& v, Index) { return 10.0 / v[0]; }};
    const Fit found = fit(problem, exact());
    IdentifyOptions options;
    options.added_sd = Eigen::VectorXd::Constant(1, 0.3);
    const Identified known = identify(problem, found, options);
    EXPECT_FALSE(known.parameters[0].is_profiled);
    EXPECT_EQ(known.num_prediction, 0);

    options.added_sd[0] = 0.1;  // the posterior's sd is 0.2
    EXPECT_TRUE(identify(problem, found, options).parameters[0].is_profiled);
}

}  // namespace
}  // namespace palpate

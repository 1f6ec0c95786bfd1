// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/kept_columns.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/estimate/fit.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

using Values = std::vector<ToyProblem::Number>;

/// y = a exp(-b t) + c with a and b by their logarithms; no values fit the data exactly.
ToyProblem decay() {
    Eigen::VectorXd measured(24);
    for (Index i = 0; i < 24; ++i)
        measured[i] = 2 * std::exp(-0.175 * double(i)) + 0.3 + 0.02 * std::sin(7.0 * double(i));
    return {
        {log_parameter("a", 1.5, 1.5, 1), log_parameter("b", 0.5, 0.5, 1),
         flat_parameter("c", 0.2)},
        toy_block(measured, 0.02),
        [](const Values& v, Index i) { return v[0] * std::exp(-v[1] * 0.25 * double(i)) + v[2]; }};
}

std::shared_ptr<const Prediction> predicted(const DataProblem& problem,
                                            const Eigen::VectorXd& values,
                                            PredictedColumns columns) {
    return checked_prediction(problem, values, columns, nullptr).prediction;
}

Eigen::MatrixXd transformed_columns_of(const Prediction& prediction,
                                       const std::vector<Parameter>& parameters) {
    return transformed_columns(
        prediction.blocks[0], slopes_of(parameters, to_transformed(parameters, prediction.values)));
}

TEST(KeptColumns, AreTheSameOnTheTransformedScale) {
    const ToyProblem problem = decay();
    const auto near = predicted(problem, Eigen::Vector3d(1.5, 0.5, 0.2), PredictedColumns::wanted);
    const auto made = predicted(problem, Eigen::Vector3d(1.8, 0.4, 0.3), PredictedColumns::none);
    const auto both = with_columns_of(near, made, problem.parameters());
    EXPECT_EQ(both->values, made->values);
    EXPECT_EQ(both->blocks[0].predicted, made->blocks[0].predicted);
    EXPECT_LT((transformed_columns_of(*both, problem.parameters()) -
               transformed_columns_of(*near, problem.parameters()))
                  .norm(),
              1e-13);
    EXPECT_GT((both->blocks[0].columns - near->blocks[0].columns).norm(), 0.1);
}

TEST(KeptColumns, KnowTheirPlaceAndWhatTheModelGaveFromStepToStep) {
    const ToyProblem problem = decay();
    const auto first = predicted(problem, Eigen::Vector3d(1.5, 0.5, 0.2), PredictedColumns::wanted);
    const auto second = predicted(problem, Eigen::Vector3d(1.6, 0.5, 0.2), PredictedColumns::none);
    const auto third = predicted(problem, Eigen::Vector3d(1.7, 0.5, 0.2), PredictedColumns::none);
    const auto after = with_columns_of(with_columns_of(first, second, problem.parameters()), third,
                                       problem.parameters());
    EXPECT_EQ(place_of_columns(*after), first->values);
    EXPECT_EQ(place_of_columns(*first), first->values);
    EXPECT_EQ(solved_of(after.get()), third.get());
    EXPECT_EQ(solved_of(third.get()), third.get());
    EXPECT_EQ(solved_of(nullptr), nullptr);
}

/// Remembers what it was asked to begin from, and for how many columns.
class Witness : public DataProblem {
public:
    explicit Witness(ToyProblem toy) : toy_(std::move(toy)) {}
    const std::vector<Parameter>& parameters() const override { return toy_.parameters(); }
    PredictionAttempt predict(const Eigen::VectorXd& values, PredictedColumns columns,
                              const Prediction* warm) const override {
        last_warm = warm;
        ++(columns == PredictedColumns::wanted ? num_with : num_without);
        return toy_.predict(values, columns, warm);
    }
    mutable const Prediction* last_warm = nullptr;
    mutable int num_with = 0, num_without = 0;

private:
    ToyProblem toy_;
};

TEST(KeptColumns, ModelsBeginFromWhatTheyGaveThemselves) {
    const Witness problem(decay());
    const auto near = predicted(problem, Eigen::Vector3d(1.5, 0.5, 0.2), PredictedColumns::wanted);
    const auto made = predicted(problem, Eigen::Vector3d(1.6, 0.5, 0.2), PredictedColumns::none);
    const auto both = with_columns_of(near, made, problem.parameters());
    checked_prediction(problem, near->values, PredictedColumns::none, both.get());
    EXPECT_EQ(problem.last_warm, made.get());
}

FitOptions options_within(double within) {
    FitOptions options;
    options.discrepancy.is_learned = false;
    options.gauss_newton.keeps_columns_within = within;
    return options;
}

double sds_between(const Fit& exact, const Fit& other) {
    const Eigen::VectorXd away = other.transformed - exact.transformed;
    return std::sqrt(away.dot(exact.equations.hessian * away));
}

TEST(KeptColumns, SaveThoseOfTheLastStep) {
    const Witness all(decay()), some(decay());
    FitOptions options = options_within(0);
    options.gauss_newton.gain_tolerance = 1e-10;
    const Fit exact = fit(all, options);
    EXPECT_EQ(all.num_without, 0);

    FitOptions near = options_within(1);
    near.start =
        to_values(some.parameters(), exact.transformed + Eigen::Vector3d(0.002, -0.002, 0.001));
    near.gauss_newton.gain_tolerance = 1e-3;
    const Fit kept = fit(some, near);
    EXPECT_EQ(some.num_with, 1);  // at the start
    EXPECT_EQ(some.num_without, 1);
    EXPECT_EQ(kept.ending, Ending::converged);
    EXPECT_EQ(kept.values, kept.prediction->values);
    EXPECT_LT(sds_between(exact, kept), 0.03);
    // what is kept is the columns alone
    const auto there = predicted(some, kept.values, PredictedColumns::none);
    EXPECT_EQ(kept.prediction->blocks[0].predicted, there->blocks[0].predicted);
}

TEST(KeptColumns, AreNotThoseOfAPlaceFarAway) {
    const Witness problem(decay());
    const Fit found = fit(problem, options_within(1));
    EXPECT_EQ(found.ending, Ending::converged);
    EXPECT_GT(problem.num_with, 1);
    const Eigen::VectorXd away =
        found.transformed -
        to_transformed(problem.parameters(), place_of_columns(*found.prediction));
    EXPECT_LT(0.5 * away.dot(found.equations.hessian * away), 1);
}

// Models that fail or bend: a search that keeps columns ends where one ends that does not.
TEST(KeptColumns, DoNotLeadBehindAWall) {
    for (const double wall : {0.5, 0.9}) {
        SCOPED_TRACE(wall);
        const auto ends = [&](double within) {
            ToyProblem problem({flat_parameter("x", 0.1)},
                               toy_block(Eigen::VectorXd::Constant(1, 2), 1),
                               [](const Values& v, Index) { return v[0]; });
            problem.fails = [&](const Eigen::VectorXd& values) { return values[0] > wall; };
            return fit(problem, options_within(within)).values[0];
        };
        EXPECT_LE(ends(1), wall);
        EXPECT_NEAR(ends(1), ends(0), 0.01);
    }
}

TEST(KeptColumns, DoNotStallInABentValley) {
    for (const double bend : {1.0, 3.0, 10.0}) {
        SCOPED_TRACE(bend);
        const auto found = [&](double within) {
            const ToyProblem problem({flat_parameter("x", -1.2), flat_parameter("y", 1)},
                                     toy_block(Eigen::Vector2d(0, 1), 0.3),
                                     [bend](const Values& v, Index row) {
                                         return row == 0 ? bend * (v[1] - v[0] * v[0]) : v[0];
                                     });
            return fit(problem, options_within(within));
        };
        const Fit exact = found(0), kept = found(1);
        EXPECT_EQ(kept.ending, Ending::converged);
        EXPECT_NEAR(kept.objective, exact.objective, 0.02);
    }
}

}  // namespace
}  // namespace palpate

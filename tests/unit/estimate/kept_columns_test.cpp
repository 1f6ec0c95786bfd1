// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/kept_columns.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

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
    constexpr double wall = 0.9;
    const auto ends = [&](double within) {
        ToyProblem toy({flat_parameter("x", 0.1)}, toy_block(Eigen::VectorXd::Constant(1, 2), 1),
                       [](const Values& v, Index) { return v[0]; });
        toy.fails = [](const Eigen::VectorXd& values) { return values[0] > wall; };
        const Witness problem(toy);
        const double x = fit(problem, options_within(within)).values[0];
        EXPECT_EQ(problem.num_without > 0, within > 0);
        return x;
    };
    EXPECT_LE(ends(1), wall);
    EXPECT_NEAR(ends(1), ends(0), 0.01);
}

TEST(KeptColumns, DoNotStallInABentValley) {
    for (const double bend : {3.0, 10.0}) {
        SCOPED_TRACE(bend);
        const Witness problem(ToyProblem({flat_parameter("x", -1.2), flat_parameter("y", 1)},
                                         toy_block(Eigen::Vector2d(0, 1), 0.3),
                                         [bend](const Values& v, Index row) {
                                             return row == 0 ? bend * (v[1] - v[0] * v[0]) : v[0];
                                         }));
        const Fit exact = fit(problem, options_within(0));
        EXPECT_EQ(problem.num_without, 0);
        const Fit kept = fit(problem, options_within(1));
        EXPECT_GT(problem.num_without, 0);
        EXPECT_EQ(kept.ending, Ending::converged);
        EXPECT_NEAR(kept.objective, exact.objective, 0.02);
    }
}

/// y = r + A x + x C x / 2 in eight rows, by random numbers: residuals of three sd are left.
ToyProblem bent_rows(std::mt19937& random, double curvature) {
    constexpr int p = 4, rows = 8;
    std::normal_distribution<double> normal;
    std::vector<Parameter> parameters;
    for (const char* name : {"a", "b", "c", "d"})
        parameters.push_back(flat_parameter(name, 1.5 * normal(random)));
    std::vector<std::array<double, 1 + p + p * p>> terms(rows);
    for (auto& row : terms) {
        row[0] = 3 * normal(random);
        for (int k = 0; k < p; ++k) row[1 + k] = normal(random) * std::pow(0.5, k);
        for (int k = 0; k < p * p; ++k)
            row[1 + p + k] = 0.5 * curvature * normal(random) * std::pow(0.5, k / p + k % p);
    }
    DataBlock data = toy_block(Eigen::VectorXd::Zero(rows), 1);
    data.is_robust = false;
    return {parameters, data, [terms](const Values& v, Index i) {
                const auto& row = terms[std::size_t(i)];
                ToyProblem::Number sum = row[0];
                for (int k = 0; k < p; ++k) {
                    sum += row[1 + k] * v[k];
                    for (int m = 0; m < p; ++m) sum += row[1 + p + p * k + m] * v[k] * v[m];
                }
                return sum;
            }};
}

// Where much is left, columns of another place may promise what no step gains: then they are made.
TEST(KeptColumns, AreRenewedWhereTheyLeadNowhere) {
    std::mt19937 random(1);
    int num_chord = 0, num_stalled = 0;
    for (int run = 0; run < 300; ++run) {
        const Witness problem(bent_rows(random, 0.2));
        FitOptions options = options_within(0);
        options.gauss_newton.gain_tolerance = 0.05;
        if (fit(problem, options).ending != Ending::converged) continue;
        options.gauss_newton.keeps_columns_within = 1;
        num_stalled += fit(problem, options).ending == Ending::stalled;
        num_chord += problem.num_without;
    }
    EXPECT_GT(num_chord, 300);
    EXPECT_LE(num_stalled, 1);
}

}  // namespace
}  // namespace palpate

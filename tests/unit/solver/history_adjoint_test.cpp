// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/history_adjoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "solver/adjoint/solid_adjoint.hpp"
#include "solver/base/error.hpp"
#include "tests/fixtures/touched_history.hpp"

namespace palpate {
namespace {

using History = fixtures::LoadHistory;
using fixtures::name_of;

Eigen::VectorXd weights(Index dofs, std::size_t i) {
    Eigen::VectorXd w(dofs);
    for (Index d = 0; d < dofs; ++d) w[d] = std::cos(0.9 * d + 0.4 * i) / (1 + i);
    return w;
}

std::vector<Equilibrium> states_of(const History& history) {
    EquilibriumOptions options;
    options.relative_tolerance = 1e-12;
    return solve_history(history.model, history.times, options);
}

/// J = sum over times of w . u
double value_of(const History& history) {
    const auto states = states_of(history);
    double sum = 0;
    for (std::size_t i = 0; i < states.size(); ++i) {
        EXPECT_TRUE(states[i].converged) << states[i].message;
        sum += weights(history.model.num_dofs(), i).dot(states[i].displacement);
    }
    return sum;
}

double difference(const History& history, double step,
                  const std::function<double&(History&)>& number) {
    History up = history, down = history;
    number(up) += step;
    number(down) -= step;
    return (value_of(up) - value_of(down)) / (2 * step);
}

HistoryGradient gradient_of(const History& history) {
    std::vector<Eigen::VectorXd> slopes;
    for (std::size_t i = 0; i < history.times.size(); ++i)
        slopes.push_back(weights(history.model.num_dofs(), i));
    return history_gradient(history.model, history.times, states_of(history), slopes);
}

void expect_gradients(const History& history, const std::string& name) {
    const HistoryGradient gradient = gradient_of(history);
    const auto expect = [&](const char* what, double found, double expected) {
        EXPECT_NEAR(found, expected, 1e-5 * std::abs(expected) + 2e-7) << name << ": " << what;
    };
    const SolidMaterial& material = history.model.materials[0];
    for (std::size_t k = 0; k < material.parameters.size(); ++k)
        expect("parameter", gradient.parameters[0][k],
               difference(history, 1e-5 * material.parameters[k], [k](History& h) -> double& {
                   return h.model.materials[0].parameters[k];
               }));
    for (std::size_t k = 0; k < material.relaxation.size(); ++k) {
        expect("amplitude", gradient.relaxation[0][k].amplitude,
               difference(history, 1e-5, [k](History& h) -> double& {
                   return h.model.materials[0].relaxation[k].amplitude;
               }));
        expect("time", gradient.relaxation[0][k].time_s,
               difference(history, 1e-5, [k](History& h) -> double& {
                   return h.model.materials[0].relaxation[k].time_s;
               }));
    }
    // A load that later times remember.
    constexpr std::size_t i = 1;
    const int up = history.model.mesh.formulation == Formulation::solid ? 2 : 1;
    for (const int axis : {0, up})
        expect("obstacle", gradient.obstacle_motion[i][0][axis],
               difference(history, 1e-5, [&](History& h) -> double& {
                   return h.times[i].loads.obstacle_motion[0][axis];
               }));
    Index wall = 0, free = 0;
    for (Index d = 0; d < history.model.num_dofs(); ++d) {
        if (history.times[i].loads.displacement[d] != 0) wall = d;
        if (!history.model.prescribed[d] && d % 7 == 1) free = d;
    }
    expect("force", gradient.force[i][free], difference(history, 1e-4, [&](History& h) -> double& {
               return h.times[i].loads.force[free];
           }));
    expect("displacement", gradient.displacement[i][wall],
           difference(history, 1e-5,
                      [&](History& h) -> double& { return h.times[i].loads.displacement[wall]; }));
}

TEST(HistoryAdjoint, GradientsThroughRelaxationAndFrictionAreThoseOfCentralDifferences) {
    int number = 0;
    for (const SolidModel& model : fixtures::solid_models())
        for (const auto which : {RelaxationOf::total, RelaxationOf::isochoric}) {
            if (which == RelaxationOf::total && number++ % 2 == 0)
                continue;  // every second will do
            const std::string name = name_of(model) + ", " + palpate::name_of(which);
            const bool is_instantaneous = which == RelaxationOf::isochoric;
            const History history = fixtures::touched_history(model, which, is_instantaneous);
            const auto states = states_of(history);
            ASSERT_TRUE(states.size() == 3 && states.back().converged)
                << name << ": " << states.back().message;
            EXPECT_GT(states[1].contact.force[0].norm(), 0.1) << name;
            expect_gradients(history, name);
        }
}

TEST(HistoryAdjoint, OneElasticTimeHasTheGradientOfItsEquilibrium) {
    const auto [model, loads] = fixtures::pulled(fixtures::solid_models()[2]);
    const SolidAssembly solid(model);
    const Eigen::VectorXd slope = weights(model.num_dofs(), 0);
    const SolidGradient expected =
        solid_gradient(solid, solve_equilibrium(solid, loads, {}), slope);
    const auto states = solve_history(model, {{1, loads}}, {});
    const HistoryGradient found = history_gradient(model, {{1, loads}}, states, {slope});
    for (std::size_t k = 0; k < expected.parameters[0].size(); ++k)
        EXPECT_NEAR(found.parameters[0][k], expected.parameters[0][k], 1e-9);
    EXPECT_LT((found.force[0] - expected.force).norm(), 1e-8 * expected.force.norm());
    EXPECT_LT((found.displacement[0] - expected.displacement).norm(),
              1e-8 * expected.displacement.norm());
}

TEST(HistoryAdjoint, StatesThatDoNotFitAreRefused) {
    const auto [model, loads] = fixtures::pulled(fixtures::solid_models()[2]);
    auto states = solve_history(model, {{1, loads}}, {});
    const Eigen::VectorXd slope = weights(model.num_dofs(), 0);
    EXPECT_THROW(history_gradient(model, {{1, loads}}, states, {}), Error);
    EXPECT_THROW(history_gradient(model, {{1, loads}, {2, loads}}, states, {slope, slope}), Error);
    EXPECT_THROW(history_gradient(model, {{1, loads}}, states, {slope.head(3)}), Error);
    states[0].converged = false;
    EXPECT_THROW(history_gradient(model, {{1, loads}}, states, {slope}), Error);
}

}  // namespace
}  // namespace palpate

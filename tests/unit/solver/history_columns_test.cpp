// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/sensitivity/history_columns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "solver/adjoint/history_adjoint.hpp"
#include "solver/base/error.hpp"
#include "tests/fixtures/touched_history.hpp"

namespace palpate {
namespace {

using fixtures::LoadHistory;
using fixtures::name_of;
using fixtures::touched_history;

constexpr double tolerance = 1e-5;  ///< of a column, relative to its norm
constexpr double step = 1e-5;       ///< of a parameter, relative above one

EquilibriumOptions tight() {
    EquilibriumOptions options;
    options.relative_tolerance = 1e-13;
    return options;
}

/// Everything that a column is about, at all times: displacements, reactions, obstacles' forces.
struct Answer {
    Eigen::VectorXd displacement, reaction, contact_force;
};

void append(Eigen::VectorXd& list, const Eigen::VectorXd& more) {
    list.conservativeResize(list.size() + more.size());
    list.tail(more.size()) = more;
}

Answer answer_of(const LoadHistory& history) {
    Answer answer;
    const auto states = solve_history(history.model, history.times, tight());
    EXPECT_EQ(states.size(), history.times.size());
    for (const Equilibrium& state : states) {
        EXPECT_TRUE(state.converged) << state.message;
        append(answer.displacement, state.displacement);
        append(answer.reaction, state.reaction);
        for (const Vec3& force : state.contact.force) append(answer.contact_force, force);
    }
    return answer;
}

Answer column_of(const std::vector<ColumnsAtTime>& columns, Eigen::Index c) {
    Answer answer;
    for (const ColumnsAtTime& at : columns) {
        append(answer.displacement, at.displacement.col(c));
        append(answer.reaction, at.reaction.col(c));
        for (const auto& force : at.contact_force) append(answer.contact_force, force.col(c));
    }
    return answer;
}

/// A parameter: the direction along it, and the history with it changed by an amount.
struct Parameter {
    HistoryDirection direction;
    std::function<void(LoadHistory&, double)> change;
    double step;
};

Answer difference(const LoadHistory& history, const Parameter& parameter) {
    LoadHistory up = history, down = history;
    parameter.change(up, parameter.step);
    parameter.change(down, -parameter.step);
    const Answer a = answer_of(up), b = answer_of(down);
    const double by = 2 * parameter.step;
    return {(a.displacement - b.displacement) / by, (a.reaction - b.reaction) / by,
            (a.contact_force - b.contact_force) / by};
}

/// The largest of the three parts' errors, each relative to the norm of that part.
double column_error(const Answer& found, const Answer& expected) {
    double worst = 0;
    const auto compare = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
        if (b.norm() > 0) worst = std::max(worst, (a - b).norm() / b.norm());
    };
    compare(found.displacement, expected.displacement);
    compare(found.reaction, expected.reaction);
    compare(found.contact_force, expected.contact_force);
    return worst;
}

/// The loads at t, linear between the times, from nothing at 0.
SolidLoads loads_at(const std::vector<LoadTime>& times, double t) {
    std::size_t i = 0;
    while (i + 1 < times.size() && times[i].time_s < t) ++i;
    const double from = i == 0 ? 0 : times[i - 1].time_s;
    const double part = (t - from) / (times[i].time_s - from);
    SolidLoads loads = times[i].loads;
    loads.displacement *= part;
    loads.force *= part;
    for (Vec3& by : loads.obstacle_motion) by *= part;
    for (double& by : loads.pressure_kpa) by *= part;
    if (i == 0) return loads;
    const SolidLoads& before = times[i - 1].loads;
    loads.displacement += (1 - part) * before.displacement;
    loads.force += (1 - part) * before.force;
    for (std::size_t c = 0; c < loads.obstacle_motion.size(); ++c)
        loads.obstacle_motion[c] += (1 - part) * before.obstacle_motion[c];
    for (std::size_t k = 0; k < loads.pressure_kpa.size(); ++k)
        loads.pressure_kpa[k] += (1 - part) * before.pressure_kpa[k];
    return loads;
}

void add_material_parameters(const LoadHistory& history, std::vector<Parameter>& list) {
    const SolidMaterial& material = history.model.materials[0];
    for (std::size_t k = 0; k < material.parameters.size(); ++k)
        list.push_back(
            {along_parameter(history.model, 0, k),
             [k](LoadHistory& h, double by) { h.model.materials[0].parameters[k] += by; },
             step * material.parameters[k]});
    for (std::size_t k = 0; k < material.relaxation.size(); ++k) {
        list.push_back(
            {along_amplitude(history.model, 0, k),
             [k](LoadHistory& h, double by) { h.model.materials[0].relaxation[k].amplitude += by; },
             step});
        list.push_back(
            {along_relaxation_time(history.model, 0, k),
             [k](LoadHistory& h, double by) { h.model.materials[0].relaxation[k].time_s += by; },
             step * material.relaxation[k].time_s});
    }
    list.push_back({along_friction(history.model, 0),
                    [](LoadHistory& h, double by) { h.model.contacts[0].friction += by; }, step});
}

void add_load_parameters(const LoadHistory& history, std::vector<Parameter>& list) {
    list.push_back({along_load_scale(history.times),
                    [](LoadHistory& h, double by) {
                        for (LoadTime& at : h.times) {
                            at.loads.displacement *= 1 + by;
                            at.loads.force *= 1 + by;
                            for (Vec3& motion : at.loads.obstacle_motion) motion *= 1 + by;
                            for (double& kpa : at.loads.pressure_kpa) kpa *= 1 + by;
                        }
                    },
                    step});
    HistoryDirection pushed = along_load_scale(history.times);
    for (SolidLoads& loads : pushed.loads) {
        loads.displacement.setZero();
        loads.force.setZero();
        loads.pressure_kpa.clear();
    }
    list.push_back({pushed,
                    [](LoadHistory& h, double by) {
                        for (LoadTime& at : h.times)
                            for (Vec3& motion : at.loads.obstacle_motion) motion *= 1 + by;
                    },
                    step});
    list.push_back({along_load_delay(history.times),
                    [](LoadHistory& h, double by) {
                        const std::vector<LoadTime> times = h.times;
                        // Beyond the last time the loads go on as before.
                        for (LoadTime& at : h.times) at.loads = loads_at(times, at.time_s - by);
                    },
                    step});
    list.push_back({along_time_shift(history.times),
                    [](LoadHistory& h, double by) {
                        for (LoadTime& at : h.times) at.time_s += by;
                    },
                    step});
    HistoryDirection stiffer;
    stiffer.name = "penalty of obstacle 0";
    stiffer.penalties = {Eigen::Vector2d(1, 0)};
    list.push_back(
        {stiffer, [](LoadHistory& h, double by) { h.model.contacts[0].stiffness_kpa_per_mm += by; },
         step * history.model.contacts[0].stiffness_kpa_per_mm});
    HistoryDirection less_slip;
    less_slip.name = "penalty on slip at obstacle 0";
    less_slip.penalties = {Eigen::Vector2d(0, 1)};
    list.push_back(
        {less_slip,
         [](LoadHistory& h, double by) { h.model.contacts[0].slip_stiffness_kpa_per_mm += by; },
         step * history.model.contacts[0].slip_stiffness_kpa_per_mm});
    list.push_back({along_size(history.model, 0, 0),
                    [](LoadHistory& h, double by) { h.model.contacts[0].obstacle.radius_mm += by; },
                    step});
}

std::vector<Parameter> parameters_of(const LoadHistory& history) {
    std::vector<Parameter> list;
    add_material_parameters(history, list);
    add_load_parameters(history, list);
    return list;
}

std::vector<HistoryDirection> directions_of(const std::vector<Parameter>& parameters) {
    std::vector<HistoryDirection> directions;
    for (const Parameter& parameter : parameters) directions.push_back(parameter.direction);
    return directions;
}

TEST(HistoryColumns, AreThoseOfCentralDifferencesForEveryKindOfParameter) {
    const std::vector<SolidModel> models = fixtures::solid_models();
    // Every second: each element, formulation, law and treatment of the volume is among them.
    for (std::size_t i = 0; i < models.size(); i += 2) {
        const auto which = i % 4 == 0 ? RelaxationOf::isochoric : RelaxationOf::total;
        const LoadHistory history = touched_history(models[i], which, i % 3 == 0);
        const std::vector<Parameter> parameters = parameters_of(history);
        const HistoryWithColumns found =
            solve_history_columns(history.model, history.times, directions_of(parameters), tight());
        ASSERT_EQ(found.columns.size(), history.times.size()) << found.states.back().message;
        for (std::size_t c = 0; c < parameters.size(); ++c) {
            const std::string name = name_of(models[i]) + ": " + parameters[c].direction.name;
            const Answer expected = difference(history, parameters[c]);
            const Answer column = column_of(found.columns, static_cast<Eigen::Index>(c));
            EXPECT_GT(expected.displacement.norm(), 1e-5) << name;
            EXPECT_GT(expected.contact_force.norm(), 1e-5) << name;
            EXPECT_LT(column_error(column, expected), tolerance) << name;
        }
    }
}

TEST(HistoryColumns, KnowPressuresThatFollowTheSurface) {
    for (const std::size_t i : {2, 7}) {
        LoadHistory history =
            touched_history(fixtures::solid_models()[i], RelaxationOf::isochoric, false);
        history.model.pressures = {{history.model.contacts[0].faces}};
        for (LoadTime& at : history.times) at.loads.pressure_kpa = {-0.3 * at.time_s};
        const std::vector<Parameter> parameters = parameters_of(history);
        const HistoryWithColumns found =
            solve_history_columns(history.model, history.times, directions_of(parameters), tight());
        ASSERT_EQ(found.columns.size(), history.times.size()) << found.states.back().message;
        for (std::size_t c = 0; c < parameters.size(); ++c)
            EXPECT_LT(column_error(column_of(found.columns, static_cast<Eigen::Index>(c)),
                                   difference(history, parameters[c])),
                      tolerance)
                << name_of(history.model) << ": " << parameters[c].direction.name;
    }
}

/// Where a node goes when the body is made larger to one side, the more the farther out it is: the
/// tops of planes and of axes stay where they are.
void move_nodes(SolidModel& model, double by) {
    for (Vec3& place : model.mesh.nodes) place.x() *= 1 + by * (1 + 0.3 * place.y());
}

Parameter shape_of(const LoadHistory& history, double apart) {
    ModelPair pair{{}, apart};
    for (const int side : {0, 1}) {
        SolidModel moved = history.model;
        move_nodes(moved, side == 0 ? -0.5 * apart : 0.5 * apart);
        pair.models[side] = std::make_shared<const SolidModel>(std::move(moved));
    }
    return {along_pair(history.model, pair),
            [](LoadHistory& h, double by) { move_nodes(h.model, by); }, step};
}

TEST(HistoryColumns, AlongPlacesOfNodesAreThoseOfCentralDifferences) {
    const std::vector<SolidModel> models = fixtures::solid_models();
    for (std::size_t i = 0; i < models.size(); i += 3) {
        LoadHistory history = touched_history(models[i], RelaxationOf::isochoric, false);
        if (i % 2 == 1) {
            history.model.pressures = {{history.model.contacts[0].faces}};
            for (LoadTime& at : history.times) at.loads.pressure_kpa = {-0.3 * at.time_s};
        }
        // what else is looked for must not notice
        const std::vector<Parameter> parameters{shape_of(history, 1e-5), parameters_of(history)[0]};
        const HistoryWithColumns found =
            solve_history_columns(history.model, history.times, directions_of(parameters), tight());
        ASSERT_EQ(found.columns.size(), history.times.size()) << found.states.back().message;
        for (std::size_t c = 0; c < parameters.size(); ++c) {
            const Answer expected = difference(history, parameters[c]);
            EXPECT_GT(expected.displacement.norm(), 1e-5) << name_of(models[i]);
            EXPECT_LT(column_error(column_of(found.columns, Eigen::Index(c)), expected), tolerance)
                << name_of(models[i]) << ", parameter " << c;
        }
    }
}

TEST(HistoryColumns, ModelsOfAPairAreAlike) {
    const LoadHistory history =
        touched_history(fixtures::solid_models()[2], RelaxationOf::isochoric, false);
    ModelPair pair = shape_of(history, 1e-5).direction.pair;
    pair.apart = 0;
    EXPECT_THROW(along_pair(history.model, pair), Error);
    pair.apart = 1e-5;
    SolidModel other = history.model;
    other.contacts[0].faces.pop_back();
    pair.models[1] = std::make_shared<const SolidModel>(std::move(other));
    EXPECT_THROW(along_pair(history.model, pair), Error);
}

LoadHistory plain_history() {
    return touched_history(fixtures::solid_models()[2], RelaxationOf::isochoric, false);
}

TEST(HistoryColumns, TheCheckCatchesABrokenColumn) {
    const LoadHistory history = plain_history();
    const Parameter parameter = parameters_of(history)[2];  // an amplitude
    HistoryWithColumns found =
        solve_history_columns(history.model, history.times, {parameter.direction}, tight());
    const Answer expected = difference(history, parameter);
    ASSERT_LT(column_error(column_of(found.columns, 0), expected), tolerance);

    // As if the last step had forgotten a ten-thousandth of what it began with.
    found.columns.back().displacement *= 1 - 1e-4;
    EXPECT_GT(column_error(column_of(found.columns, 0), expected), tolerance);
}

std::size_t num_newton_steps(const std::vector<Equilibrium>& states) {
    std::size_t sum = 0;
    for (const Equilibrium& state : states) sum += state.records.size();
    return sum;
}

TEST(HistoryGuesses, FromColumnsLeadToTheSameStatesInFewerSteps) {
    const LoadHistory history = plain_history();
    const Parameter parameter = parameters_of(history)[0];
    const HistoryWithColumns centre =
        solve_history_columns(history.model, history.times, {parameter.direction}, tight());
    const double by = 0.02 * history.model.materials[0].parameters[0];
    LoadHistory moved = history;
    parameter.change(moved, by);
    std::vector<Eigen::VectorXd> guesses;
    for (std::size_t i = 0; i < centre.states.size(); ++i)
        guesses.push_back(centre.states[i].displacement +
                          by * centre.columns[i].displacement.col(0));
    const auto cold = solve_history(moved.model, moved.times, tight());
    const auto warm = solve_history(moved.model, moved.times, tight(), {}, {}, guesses);
    ASSERT_EQ(warm.size(), cold.size());
    for (std::size_t i = 0; i < cold.size(); ++i) {
        ASSERT_TRUE(warm[i].converged) << warm[i].message;
        EXPECT_LT((warm[i].displacement - cold[i].displacement).norm(),
                  1e-9 * cold[i].displacement.norm());
    }
    EXPECT_LT(num_newton_steps(warm), num_newton_steps(cold));
}

// What guesses are off by is followed in a straight line, whatever the steps.
TEST(HistoryGuesses, ThatAreOffByMoreAndMoreAreMetAtTheThirdTime) {
    LoadHistory history = plain_history();
    double before_s = 0;
    for (std::size_t i = 0; i < history.times.size(); ++i)
        before_s = history.times[i].time_s = before_s + (i % 2 ? 0.3 : 0.5);
    ASSERT_GE(history.times.size(), 3u);
    const auto answers = solve_history(history.model, history.times, tight());
    std::vector<Eigen::VectorXd> guesses;
    for (std::size_t i = 0; i < answers.size(); ++i) {
        ASSERT_TRUE(answers[i].converged) << answers[i].message;
        guesses.push_back(answers[i].displacement -
                          1e-3 * (1 + history.times[i].time_s) * answers[0].displacement);
    }
    const auto found = solve_history(history.model, history.times, tight(), {}, {}, guesses);
    ASSERT_EQ(found.size(), answers.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        SCOPED_TRACE(i);
        ASSERT_TRUE(found[i].converged) << found[i].message;
        ASSERT_FALSE(found[i].records.empty());
        const double first = found[i].records[0].relative_residual;
        if (i < 2)
            EXPECT_GT(first, 1e-5);
        else
            EXPECT_LT(first, 1e-7);
    }
}

TEST(HistoryGuesses, ThatAreFarOffDoNoHarm) {
    const LoadHistory history = plain_history();
    const auto cold = solve_history(history.model, history.times, tight());
    std::vector<Eigen::VectorXd> guesses;
    for (const Equilibrium& state : cold) {
        Eigen::VectorXd wild(state.displacement.size());
        for (Eigen::Index d = 0; d < wild.size(); ++d) wild[d] = 3 * std::sin(7.0 * d);
        guesses.push_back(wild);
    }
    const auto found = solve_history(history.model, history.times, tight(), {}, {}, guesses);
    ASSERT_EQ(found.size(), cold.size());
    for (std::size_t i = 0; i < cold.size(); ++i) {
        ASSERT_TRUE(found[i].converged) << found[i].message;
        EXPECT_LT((found[i].displacement - cold[i].displacement).norm(),
                  1e-9 * cold[i].displacement.norm());
    }
}

TEST(HistoryColumns, LeaveTheHistoryAsItIsToTheLastBit) {
    const LoadHistory history = plain_history();
    const auto expected = solve_history(history.model, history.times, {});
    const auto found =
        solve_history_columns(history.model, history.times, directions_of(parameters_of(history)));
    ASSERT_EQ(found.states.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(found.states[i].displacement, expected[i].displacement);
        EXPECT_EQ(found.states[i].reaction, expected[i].reaction);
        EXPECT_EQ(found.states[i].contact.force, expected[i].contact.force);
        EXPECT_EQ(found.states[i].records.size(), expected[i].records.size());
    }
}

// J = sum over times of w . u
TEST(HistoryColumns, AgreeWithTheAdjoint) {
    const LoadHistory history = plain_history();
    const std::vector<Parameter> parameters = parameters_of(history);
    const HistoryWithColumns found =
        solve_history_columns(history.model, history.times, directions_of(parameters), tight());
    std::vector<Eigen::VectorXd> weights;
    for (std::size_t i = 0; i < history.times.size(); ++i) {
        Eigen::VectorXd w(history.model.num_dofs());
        for (Eigen::Index d = 0; d < w.size(); ++d) w[d] = std::cos(0.9 * d + 0.4 * i) / (1 + i);
        weights.push_back(w);
    }
    const HistoryGradient gradient =
        history_gradient(history.model, history.times, found.states, weights);
    const auto slope = [&](std::size_t c) {
        double sum = 0;
        for (std::size_t i = 0; i < weights.size(); ++i)
            sum += weights[i].dot(found.columns[i].displacement.col(static_cast<Eigen::Index>(c)));
        return sum;
    };
    const auto expect = [&](std::size_t c, double expected) {
        EXPECT_NEAR(slope(c), expected, 1e-8 * std::abs(expected)) << parameters[c].direction.name;
    };
    const std::size_t num = history.model.materials[0].parameters.size();
    for (std::size_t k = 0; k < num; ++k) expect(k, gradient.parameters[0][k]);
    for (std::size_t k = 0; k < 2; ++k) {
        expect(num + 2 * k, gradient.relaxation[0][k].amplitude);
        expect(num + 2 * k + 1, gradient.relaxation[0][k].time_s);
    }
    double by_scale = 0;  // dJ/dloads . loads
    for (std::size_t i = 0; i < history.times.size(); ++i) {
        const SolidLoads& loads = history.times[i].loads;
        by_scale += gradient.force[i].dot(loads.force) +
                    gradient.displacement[i].dot(loads.displacement) +
                    gradient.obstacle_motion[i][0].dot(loads.obstacle_motion[0]);
    }
    expect(num + 5, by_scale);
}

TEST(HistoryColumns, WhatHasNoColumnsIsRefused) {
    LoadHistory history = plain_history();
    const SolidModel& model = history.model;
    EXPECT_THROW(along_parameter(model, 0, 7), Error);
    EXPECT_THROW(along_parameter(model, 1, 0), Error);
    EXPECT_THROW(along_amplitude(model, 0, 2), Error);
    EXPECT_THROW(along_friction(model, 1), Error);
    EXPECT_THROW(along_size(model, 1, 0), Error);
    EXPECT_THROW(along_size(model, 0, 4), Error);
    HistoryDirection short_of_loads = along_load_scale(history.times);
    short_of_loads.loads.pop_back();
    EXPECT_THROW(HistoryColumns(model, history.times, {short_of_loads}), Error);

    HistoryColumns columns(model, history.times, {along_parameter(model, 0, 0)});
    const SolidAssembly solid(model);
    const auto states = solve_history(model, history.times, {});
    EXPECT_THROW(columns.advance(solid, states[0]), Error);  // its tangent is gone
    history.model.contacts[0].friction = 0;
    EXPECT_THROW(along_friction(history.model, 0), Error);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/sensitivity/columns_beside.hpp"

#include <gtest/gtest.h>

#include "solver/base/error.hpp"
#include "tests/fixtures/touched_history.hpp"

namespace palpate {
namespace {

using fixtures::LoadHistory;

LoadHistory history_with(double friction) {
    LoadHistory history =
        fixtures::touched_history(fixtures::solid_models()[2], RelaxationOf::isochoric, false);
    for (Contact& contact : history.model.contacts) contact.friction = friction;
    return history;
}

std::vector<HistoryDirection> directions_of(const LoadHistory& history) {
    return {along_parameter(history.model, 0, 0), along_amplitude(history.model, 0, 0),
            along_relaxation_time(history.model, 0, 1), along_size(history.model, 0, 0),
            along_load_scale(history.times)};
}

EquilibriumOptions tight() {
    EquilibriumOptions options;
    options.relative_tolerance = 1e-13;
    return options;
}

double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / b.norm();
}

TEST(ColumnsBeside, AreThoseOnTheWay) {
    for (const double friction : {0.0, 0.3}) {
        SCOPED_TRACE(friction);
        const LoadHistory history = history_with(friction);
        const HistoryWithColumns expected =
            solve_history_columns(history.model, history.times, directions_of(history), tight());
        ColumnsBeside beside(history.model, history.times, directions_of(history), tight());
        const auto states = solve_history(
            history.model, history.times, tight(), {},
            [&](const SolidAssembly&, const Equilibrium& found) { beside.follow(found); });
        const std::vector<ColumnsAtTime> found = beside.finish({});
        ASSERT_EQ(found.size(), history.times.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(states[i].displacement, expected.states[i].displacement);
            EXPECT_LT(distance(found[i].displacement, expected.columns[i].displacement), 1e-9);
            EXPECT_LT(distance(found[i].reaction, expected.columns[i].reaction), 1e-9);
            ASSERT_EQ(found[i].contact_force.size(), expected.columns[i].contact_force.size());
            for (std::size_t k = 0; k < found[i].contact_force.size(); ++k)
                EXPECT_LT(distance(found[i].contact_force[k], expected.columns[i].contact_force[k]),
                          1e-9);
        }
        EXPECT_TRUE(beside.finish({}).empty());
    }
}

TEST(ColumnsBeside, SayAtTheEndWhatAnAdvanceThrew) {
    const LoadHistory history = history_with(0);
    ColumnsBeside beside(history.model, history.times, directions_of(history), {});
    Equilibrium lost;
    lost.displacement.setZero(history.model.num_dofs());
    beside.follow(lost);
    EXPECT_THROW(beside.finish({}), Error);
    EXPECT_THROW(beside.follow(lost), Error);
    EXPECT_THROW(beside.finish({}), Error);

    ColumnsBeside too_many(history.model, history.times, directions_of(history), {});
    solve_history(history.model, history.times, {}, {},
                  [&](const SolidAssembly&, const Equilibrium& found) { too_many.follow(found); });
    Equilibrium once_more;
    once_more.converged = true;
    once_more.displacement.setZero(history.model.num_dofs());
    too_many.follow(once_more);
    EXPECT_THROW(too_many.finish({}), Error);

    HistoryDirection short_of_loads = along_load_scale(history.times);
    short_of_loads.loads.pop_back();
    EXPECT_THROW(ColumnsBeside(history.model, history.times, {short_of_loads}, {}), Error);
}

TEST(ColumnsBeside, NobodyWaitsForEndWithTheirObject) {
    const LoadHistory history = history_with(0);
    {
        ColumnsBeside left(history.model, history.times, directions_of(history), {});
        EXPECT_THROW(solve_history(history.model, history.times, {}, {},
                                   [&](const SolidAssembly&, const Equilibrium& found) {
                                       left.follow(found);
                                       throw Error(ErrorCode::cancelled, "enough");
                                   }),
                     Error);
    }
    ColumnsBeside beside(history.model, history.times, directions_of(history), {});
    solve_history(history.model, history.times, {}, {},
                  [&](const SolidAssembly&, const Equilibrium& found) { beside.follow(found); });
}

}  // namespace
}  // namespace palpate

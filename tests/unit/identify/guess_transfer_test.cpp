// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/guess_transfer.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "host/apps/identify/resolution.hpp"

namespace palpate {
namespace {

SimulationSettings graded_body() {
    return parse_simulation(
        "[mesh]\nformulation = \"axisymmetric\"\nvolume = \"element-mean\"\ngraded = {width_mm = "
        "20, depth_mm = 16, edge_mm = 5, columns_inside = 8, columns_outside = 4, rows = 8}\n"
        "[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = 10\npoisson_ratio = 0.4\n"
        "[[fix]]\nwhere = {side = \"y-min\"}\n[[pressure]]\nwhere = {point_array = \"surface\"}\n"
        "kpa = 1\ncolumn = \"share\"\n[history]\ntime_s = [1, 2, 3, 4]\nshare = [0.2, 0.5, 0.8, "
        "1]\n",
        "m.toml", {});
}

std::vector<Eigen::VectorXd> displacements_of(const SimulationResult& run) {
    std::vector<Eigen::VectorXd> all;
    for (const SimulationState& state : run.states) all.push_back(state.displacement);
    return all;
}

/// How many nodes of a mesh stand where nodes of another one do, and have its displacements.
Index num_common(const SolidMesh& mesh, const Eigen::VectorXd& u, const SolidMesh& other,
                 const Eigen::VectorXd& other_u) {
    Index count = 0;
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        for (Index m = 0; m < other.num_nodes(); ++m)
            if ((mesh.nodes[n] - other.nodes[m]).norm() < 1e-9) {
                EXPECT_EQ(u.segment<3>(3 * n), other_u.segment<3>(3 * m));
                ++count;
            }
    return count;
}

TEST(GuessTransfer, IsNearWhatOtherCellsAndTimesAnswer) {
    const SimulationSettings own = graded_body();
    const SimulationResult from = run_simulation(own);
    ASSERT_TRUE(from.converged());
    using Resizing = bool (*)(SimulationSettings&);
    const std::vector<std::vector<Resizing>> all{{halve_cells},
                                                 {double_cells},
                                                 {halve_steps},
                                                 {double_steps},
                                                 {halve_cells, double_steps},
                                                 {halve_steps, double_cells}};
    for (std::size_t k = 0; k < all.size(); ++k) {
        SCOPED_TRACE(k);
        SimulationSettings other = own;
        for (const Resizing resized : all[k]) ASSERT_TRUE(resized(other));
        const SimulationResult there = run_simulation(other);
        const auto guesses = transferred_guesses(other, from, displacements_of(from));
        ASSERT_EQ(guesses.size(), other.history->time_s.size());
        for (std::size_t step = 0; step < guesses.size(); ++step) {
            const Eigen::VectorXd& answer = there.states[step + 1].displacement;
            ASSERT_EQ(guesses[step].size(), answer.size());
            // beside what cells of so few have wrong; nodes in another order are off by all of it
            EXPECT_LT((guesses[step] - answer).norm(), 0.2 * answer.norm());
        }
        EXPECT_EQ(
            num_common(there.mesh(), guesses.back(), from.mesh(), from.states.back().displacement),
            std::min(there.mesh().num_nodes(), from.mesh().num_nodes()));
    }
}

TEST(GuessTransfer, TheSameCellsAndTimesGetTheDisplacementsThemselves) {
    const SimulationSettings own = graded_body();
    const SimulationResult from = run_simulation(own);
    const auto guesses = transferred_guesses(own, from, displacements_of(from));
    ASSERT_EQ(guesses.size(), from.states.size() - 1);
    for (std::size_t step = 0; step < guesses.size(); ++step)
        EXPECT_EQ(guesses[step], from.states[step + 1].displacement);
}

TEST(GuessTransfer, OtherMeshesAndLoadsGetNone) {
    const SimulationSettings own = graded_body();
    const SimulationResult from = run_simulation(own);
    SimulationSettings other = own;
    ASSERT_TRUE(halve_cells(other));
    ASSERT_TRUE(halve_cells(other));
    EXPECT_TRUE(transferred_guesses(other, from, displacements_of(from)).empty());
    other = own;
    other.mesh.graded->rows = 10;
    EXPECT_TRUE(transferred_guesses(other, from, displacements_of(from)).empty());
    other = own;
    other.mesh.graded.reset();
    EXPECT_TRUE(transferred_guesses(other, from, displacements_of(from)).empty());
    other = own;
    other.history.reset();
    EXPECT_TRUE(transferred_guesses(other, from, displacements_of(from)).empty());
}

}  // namespace
}  // namespace palpate

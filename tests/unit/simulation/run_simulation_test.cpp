// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/run_simulation.hpp"

#include <gtest/gtest.h>

#include "host/apps/simulate/simulation_findings.hpp"
#include "host/apps/simulate/simulation_page.hpp"
#include "host/apps/simulate/simulation_tree.hpp"
#include "host/page/tree_json.hpp"
#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

/// A box on three smooth sides, its top moved along z.
std::string stretched_box(double z_mm, const std::string& more = "") {
    return box_mesh + one_material + more +
           "[[fix]]\nname = \"bottom\"\nwhere = {side = \"z-min\"}\ncomponents = \"z\"\n"
           "[[fix]]\nname = \"left\"\nwhere = {side = \"x-min\"}\ncomponents = \"x\"\n"
           "[[fix]]\nname = \"front\"\nwhere = {side = \"y-min\"}\ncomponents = \"y\"\n"
           "[[move]]\nname = \"top\"\nwhere = {side = \"z-max\"}\nz_mm = " +
           std::to_string(z_mm) + "\n";
}

TEST(RunSimulation, AUniformStretchHasOneStressAndItsForce) {
    const SimulationResult result = run_simulation(parsed(stretched_box(0.2)));

    ASSERT_TRUE(result.converged());
    ASSERT_EQ(result.states.size(), 2u);
    const SimulationState& state = result.states.back();
    const std::array<double, 6>& stress = state.cells.stress_kpa.front();
    for (std::size_t e = 0; e < state.cells.von_mises_kpa.size(); ++e) {
        EXPECT_NEAR(state.cells.von_mises_kpa[e], stress[2], 1e-6 * stress[2]);
        EXPECT_NEAR(state.cells.volume_ratio[e], state.cells.volume_ratio[0], 1e-9);
    }
    // The force is the Cauchy stress on the deformed area.
    const double ratio = state.cells.volume_ratio[0];
    const double area = 16 * ratio / 1.1;
    EXPECT_NEAR(state.force_mn[3].z(), stress[2] * area, 1e-6 * stress[2] * area);
    EXPECT_NEAR(state.force_mn[0].z(), -state.force_mn[3].z(), 1e-6);
    // And the work on a path of small steps is what is stored.
    EXPECT_NEAR(volume_change(result, state).after_mm3, 32 * ratio, 1e-9);
}

TEST(RunSimulation, WorkOfTheForcesIsStored) {
    const SimulationResult result =
        run_simulation(parsed(stretched_box(0.4) + "[newton]\nload_steps = 40\n"));

    double work = 0;
    for (std::size_t k = 1; k < result.states.size(); ++k)
        work +=
            0.01 * 0.5 * (result.states[k].force_mn[3].z() + result.states[k - 1].force_mn[3].z());
    EXPECT_NEAR(result.states.back().energy_mn_mm, work, 1e-3 * work);
}

TEST(RunSimulation, StressesOfRelaxationAreThoseThatTheForceCarries) {
    const SimulationResult result = run_simulation(
        parsed(stretched_box(0.2, "relaxation = [{amplitude = 1, time_s = 1}]\n") +
               "column = \"pull\"\n[history]\ntime_s = [0.001, 1, 8]\npull = [1, 1, 1]\n"));

    ASSERT_EQ(result.states.size(), 4u);
    for (std::size_t k = 1; k < 4; ++k) {
        const CellFields& cells = result.states[k].cells;
        const double area = 16 * cells.volume_ratio[0] / 1.1;
        EXPECT_NEAR(result.states[k].force_mn[3].z(), cells.stress_kpa[0][2] * area, 1e-6 * area);
    }
    EXPECT_LT(result.states[3].cells.stress_kpa[0][2],
              0.6 * result.states[1].cells.stress_kpa[0][2]);
}

TEST(RunSimulation, ALoadBeyondReachIsReportedWithWhatWasReached) {
    const SimulationResult result =
        run_simulation(parsed(stretched_box(-3) + "[newton]\nload_steps = 4\n"));

    EXPECT_FALSE(result.converged());
    EXPECT_LT(result.states.back().time_s, 0.67);  // where the box would be flat
    EXPECT_GT(result.states.back().time_s, 0.2);
    EXPECT_NE(convergence_sentence(result).find("NOT converge"), std::string::npos);
    EXPECT_NE(simulation_page(result).find("Not converged."), std::string::npos);
    EXPECT_NE(tree_json(simulation_tree(result)).find("\"converged\": false"), std::string::npos);
}

TEST(RunSimulation, TextsFromTheFileAreEscapedOnThePage) {
    std::string toml = "title = \"a <b> & 'c'\"\n" + stretched_box(0.1);
    toml.replace(toml.find("\"top\""), 5, "\"<i>top</i>\"");
    const std::string page = simulation_page(run_simulation(parsed(toml)));

    EXPECT_EQ(page.find("<b>"), std::string::npos);
    EXPECT_EQ(page.find("<i>top"), std::string::npos);
    EXPECT_NE(page.find("&lt;i&gt;top"), std::string::npos);
}

TEST(RunSimulation, ReactionsHaveAColumnPerComponentOfEachSupport) {
    const std::string csv = reactions_csv(run_simulation(parsed(stretched_box(0.1))));

    EXPECT_EQ(csv.substr(0, csv.find('\n')),
              "load,bottom_x_mn,bottom_y_mn,bottom_z_mn,left_x_mn,left_y_mn,left_z_mn,front_x_mn,"
              "front_y_mn,front_z_mn,top_x_mn,top_y_mn,top_z_mn");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
}

}  // namespace
}  // namespace palpate

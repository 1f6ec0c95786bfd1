// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/resolution.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

SimulationSettings model(const std::string& of_load) {
    return parse_simulation(
        "[mesh]\nformulation = \"plane-strain\"\nrectangle = {size_mm = [10, 4], divisions = [4, "
        "2]}\n[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = 10\npoisson_ratio = 0.3\n"
        "[[fix]]\nwhere = {side = \"x-min\"}\n[[move]]\nwhere = {side = \"x-max\"}\nx_mm = 1\n" +
            of_load + "[history]\ntime_s = [1, 3]\npull = [0.5, 1]\n",
        "m.toml", {});
}

TEST(Resolution, CellsAndStepsAreHalved) {
    SimulationSettings settings = model("column = \"pull\"\n");
    ASSERT_TRUE(halve_cells(settings));
    EXPECT_EQ(settings.mesh.grid.divisions[0], 8);
    EXPECT_EQ(settings.mesh.grid.divisions[1], 4);
    ASSERT_TRUE(halve_steps(settings));
    EXPECT_EQ(settings.history->time_s, (std::vector<double>{0.5, 1, 2, 3}));
    const std::vector<std::vector<double>> factors{{0.25}, {0.5}, {0.75}, {1}};
    EXPECT_EQ(settings.history->factors, factors);
}

TEST(Resolution, ALoadWithoutColumnKeepsTheFirstStep) {
    SimulationSettings settings = model("");
    ASSERT_TRUE(halve_steps(settings));
    EXPECT_EQ(settings.history->time_s, (std::vector<double>{1, 2, 3}));
}

TEST(Resolution, AMeshOfAFileAndAStaticLoadStayAsTheyAre) {
    SimulationSettings settings = model("column = \"pull\"\n");
    settings.mesh.file = "liver.vtu";
    EXPECT_FALSE(halve_cells(settings));
    settings.history.reset();
    EXPECT_FALSE(halve_steps(settings));
}

/// A graded body, and a history of `times` times.
SimulationSettings graded_model(const std::string& mesh, const std::string& times) {
    return parse_simulation(
        "[mesh]\nformulation = \"axisymmetric\"\ngraded = {width_mm = 20, depth_mm = 16, edge_mm "
        "= 5, " +
            mesh +
            "}\n[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = 10\npoisson_ratio = 0.3\n"
            "[[fix]]\nwhere = {side = \"y-min\"}\n[[pressure]]\nwhere = {point_array = "
            "\"surface\"}\nkpa = 1\ncolumn = \"share\"\n[history]\n" +
            times,
        "m.toml", {});
}

TEST(Resolution, CellsAndStepsAreTakenTogetherByTwo) {
    const std::string even = "columns_inside = 8, columns_outside = 6, rows = 12";
    SimulationSettings settings =
        graded_model(even, "time_s = [0.5, 1, 2, 3]\nshare = [0.1, 0.5, 0.7, 1]\n");
    ASSERT_TRUE(double_cells(settings));
    EXPECT_EQ(settings.mesh.graded->coarsen, 2);
    EXPECT_FALSE(double_cells(settings));  // 6 columns, by fours
    ASSERT_TRUE(double_steps(settings));
    EXPECT_EQ(settings.history->time_s, (std::vector<double>{1, 3}));
    EXPECT_EQ(settings.history->factors, (std::vector<std::vector<double>>{{0.5}, {1}}));
    // what a finer model has divided is taken together first
    settings = graded_model(even + ", refine = 2", "time_s = [1]\nshare = [1]\n");
    ASSERT_TRUE(double_cells(settings));
    EXPECT_EQ(settings.mesh.graded->refine, 1);
    EXPECT_EQ(settings.mesh.graded->coarsen, 1);
}

TEST(Resolution, WhatHasNoPairsIsLeft) {
    SimulationSettings settings = graded_model("columns_inside = 8, columns_outside = 5, rows = 12",
                                               "time_s = [1, 2, 3]\nshare = [0.1, 0.5, 1]\n");
    EXPECT_FALSE(double_cells(settings));
    EXPECT_EQ(settings.mesh.graded->coarsen, 1);
    EXPECT_FALSE(double_steps(settings));
    EXPECT_EQ(settings.history->time_s.size(), 3u);
    settings = model("column = \"pull\"\n");
    EXPECT_FALSE(double_cells(settings));
}

}  // namespace
}  // namespace palpate

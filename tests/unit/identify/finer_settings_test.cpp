// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/finer_settings.hpp"

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

TEST(FinerSettings, CellsAndStepsAreHalved) {
    SimulationSettings settings = model("column = \"pull\"\n");
    ASSERT_TRUE(halve_cells(settings));
    EXPECT_EQ(settings.mesh.grid.divisions[0], 8);
    EXPECT_EQ(settings.mesh.grid.divisions[1], 4);
    ASSERT_TRUE(halve_steps(settings));
    EXPECT_EQ(settings.history->time_s, (std::vector<double>{0.5, 1, 2, 3}));
    const std::vector<std::vector<double>> factors{{0.25}, {0.5}, {0.75}, {1}};
    EXPECT_EQ(settings.history->factors, factors);
}

TEST(FinerSettings, ALoadWithoutColumnKeepsTheFirstStep) {
    SimulationSettings settings = model("");
    ASSERT_TRUE(halve_steps(settings));
    EXPECT_EQ(settings.history->time_s, (std::vector<double>{1, 2, 3}));
}

TEST(FinerSettings, AMeshOfAFileAndAStaticLoadStayAsTheyAre) {
    SimulationSettings settings = model("column = \"pull\"\n");
    settings.mesh.file = "liver.vtu";
    EXPECT_FALSE(halve_cells(settings));
    settings.history.reset();
    EXPECT_FALSE(halve_steps(settings));
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

void expect_complaint(const std::string& toml, const std::vector<std::string>& words) {
    expect_refused([&] { parsed(toml); }, words);
}

const std::string full_example = R"(
title = "all of it"
[mesh]
formulation = "plane-strain"
thickness_mm = 2
rectangle = {size_mm = [10, 5], divisions = [4, 2], origin_mm = [1, 2], element = "tri3"}
quadratic = true
volume = "element-mean"
[[mesh.part]]
region = 7
where = {centre_mm = [3, 4], radius_mm = 1.5}
[[material]]
region = 1
law = "linear"
stiffness_kpa = 5
poisson_ratio = 0.3
relaxation = [{amplitude = 0.5, time_s = 2}, {amplitude = 0.25, time_s = 20}]
relaxation_of = "total"
instantaneous = true
[[material]]
region = 7
law = "neo-hookean-reduced"
mu_kpa = 3
kappa_kpa = 50
[[fix]]
where = {side = "y-min"}
components = "y"
[[move]]
name = "plate"
where = {from_mm = [1, 7], to_mm = [11, 7], tolerance_mm = 0.01}
y_mm = -0.5
column = "press"
[[force]]
where = {side = "x-max"}
total_mn = [1, 2]
[[force]]
name = "weights"
where = {side = "x-min"}
nodal_mn = [0.5, 0]
[[pressure]]
where = {side = "x-min"}
kpa = 1.5
[[traction]]
where = {side = "x-max"}
kpa = [0.1, 0.2]
[[obstacle]]
shape = "sphere"
place_mm = [5, 20]
radius_mm = 3
friction = 0.2
motion_mm = [0, -1]
stiffness_kpa_per_mm = 40
column = "press"
[history]
time_s = [1, 2]
press = [1, 0.5]
[newton]
relative_tolerance = 1e-7
max_steps = 20
first_step = 0.5
smallest_step = 0.01
)";

TEST(ReadSimulation, TakesEveryKeyOfTheExample) {
    const SimulationSettings s = parsed(full_example);

    EXPECT_EQ(s.title, "all of it");
    EXPECT_EQ(s.mesh.formulation, Formulation::plane_strain);
    EXPECT_DOUBLE_EQ(s.mesh.thickness_mm, 2);
    EXPECT_EQ(s.mesh.grid.type, ElementType::tri3);
    EXPECT_EQ(s.mesh.grid.origin_mm, Vec3(1, 2, 0));
    EXPECT_TRUE(s.mesh.quadratic);
    EXPECT_EQ(s.mesh.volume, VolumeTreatment::element_mean);
    ASSERT_EQ(s.mesh.parts.size(), 1u);
    EXPECT_EQ(s.mesh.parts[0].region, 7);
    ASSERT_EQ(s.materials.size(), 2u);
    EXPECT_EQ(s.materials[0].material.parameters, (std::vector<double>{5, 0.3}));
    ASSERT_EQ(s.materials[0].material.relaxation.size(), 2u);
    EXPECT_DOUBLE_EQ(s.materials[0].material.relaxation[1].time_s, 20);
    EXPECT_EQ(s.materials[0].material.relaxation_of, RelaxationOf::total);
    EXPECT_TRUE(s.materials[0].material.is_instantaneous);
    ASSERT_EQ(s.supports.size(), 2u);
    EXPECT_EQ(s.supports[0].name, "fix 1");
    EXPECT_FALSE(s.supports[0].displacement_mm[0]);
    EXPECT_EQ(s.supports[0].displacement_mm[1], 0);
    EXPECT_EQ(s.supports[1].displacement_mm[1], -0.5);
    EXPECT_EQ(s.supports[1].column, 0u);
    ASSERT_EQ(s.forces.size(), 2u);
    EXPECT_TRUE(s.forces[0].is_total);
    EXPECT_FALSE(s.forces[1].is_total);
    ASSERT_EQ(s.surface_loads.size(), 2u);
    EXPECT_DOUBLE_EQ(s.surface_loads[0].pressure_kpa, 1.5);
    EXPECT_EQ(s.surface_loads[1].traction_kpa, Vec3(0.1, 0.2, 0));
    ASSERT_EQ(s.obstacles.size(), 1u);
    EXPECT_EQ(s.obstacles[0].obstacle.shape, ObstacleShape::sphere);
    EXPECT_EQ(s.obstacles[0].motion_mm, Vec3(0, -1, 0));
    ASSERT_TRUE(s.history);
    EXPECT_EQ(s.history->columns, (std::vector<std::string>{"press"}));
    EXPECT_EQ(s.newton.max_newton_steps, 20);
    EXPECT_DOUBLE_EQ(s.newton.smallest_step, 0.01);
}

TEST(ReadSimulation, WithoutNewtonAndHistoryItIsOneStaticLoadWithTheSolversOptions) {
    const SimulationSettings s = parsed(box_mesh + one_material + held_base);

    EXPECT_FALSE(s.history);
    EXPECT_EQ(s.load_steps, 1);
    EXPECT_DOUBLE_EQ(s.newton.relative_tolerance, EquilibriumOptions{}.relative_tolerance);
}

TEST(ReadSimulation, UnknownKeysAreRefusedWithLineAndGuess) {
    expect_complaint(box_mesh + one_material + "[[fixed]]\n", {"'fixed'", "did you mean 'fix'"});
    expect_complaint(box_mesh + "quadratik = true\n" + one_material,
                     {"model.toml, line 3", "[mesh]", "'quadratik'", "'quadratic'"});
    expect_complaint(box_mesh + one_material + "mu_kpa = 3\n",
                     {"line 7", "[[material]]", "'mu_kpa'", "stiffness_kpa, poisson_ratio"});
    expect_complaint(box_mesh + one_material + "[[fix]]\nwhere = {sid = \"z-min\"}\n",
                     {"line 8", "[[fix]] number 1 [where]", "'sid'", "'side'"});
}

TEST(ReadSimulation, MaterialsAreCheckedAgainstTheirTable) {
    const std::string law = box_mesh + "[[material]]\nlaw = \"neo-hookean\"\n";
    expect_complaint(box_mesh, {"[[material]]", "what the body is made of"});
    expect_complaint(box_mesh + "[[material]]\nlaw = \"rubber\"\n",
                     {"line 4", "rubber", "neo-hookean", "veronda-westmann"});
    expect_complaint(law, {"'stiffness_kpa' is missing", "above 0 kPa", "Young's modulus"});
    expect_complaint(law + "stiffness_kpa = -3\npoisson_ratio = 0.3\n",
                     {"line 5", "'stiffness_kpa' is -3", "above 0 kPa"});
    expect_complaint(law + "stiffness_kpa = \"soft\"\npoisson_ratio = 0.3\n",
                     {"'stiffness_kpa' is", "soft", "above 0 kPa"});
    expect_complaint(
        law + "stiffness_kpa = 3\npoisson_ratio = 0.3\nrelaxation = [{amplitude = 1}]\n",
        {"[[relaxation]] number 1", "'time_s' is missing"});
    expect_complaint(box_mesh + one_material + one_material, {"'region' is missing", "several"});
}

TEST(ReadSimulation, RelaxationIsOfTheIsochoricStressUnlessTheFileSaysOtherwise) {
    const std::string relaxing =
        box_mesh + one_material + "relaxation = [{amplitude = 1, time_s = 1}]\n";
    const SolidMaterial material = parsed(relaxing).materials[0].material;
    EXPECT_EQ(material.relaxation_of, RelaxationOf::isochoric);
    EXPECT_FALSE(material.is_instantaneous);
    expect_complaint(relaxing + "relaxation_of = \"deviatoric\"\n",
                     {"line 8", "'relaxation_of'", "isochoric", "total"});
    expect_complaint(relaxing + "instantaneous = true\n",
                     {"line 8", "'instantaneous'", "[history]"});
    expect_complaint(box_mesh + one_material + "relaxation_of = \"total\"\n",
                     {"line 7", "'relaxation_of'", "relaxation = ["});
}

TEST(ReadSimulation, AMeshNeedsOneSource) {
    expect_complaint(one_material, {"there is no [mesh]"});
    expect_complaint("[mesh]\n" + one_material, {"line 1", "file", "box"});
    expect_complaint(
        "[mesh]\nformulation = \"plane-stress\"\n"
        "box = {size_mm = [1, 1, 1], divisions = [1, 1, 1]}\n" +
            one_material,
        {"line 3", "plane-stress", "rectangle"});
    expect_complaint("[mesh]\nbox = {size_mm = [1, 1], divisions = [1, 1, 1]}\n" + one_material,
                     {"line 2", "'size_mm'", "3 numbers"});
    expect_complaint(
        "[mesh]\nbox = {size_mm = [1, 1, 1], divisions = [1, 1, 0.5]}\n" + one_material,
        {"'divisions'", "whole numbers from 1"});
    expect_refused([] { parsed("[mesh]\nfile = \"nowhere.vtu\"\n" + one_material); },
                   {"nowhere.vtu", "no such file"}, ErrorCode::input_unreadable);
    expect_complaint(
        "[mesh]\nformulation = \"plane-stress\"\nvolume = \"element-mean\"\n"
        "rectangle = {size_mm = [1, 1], divisions = [1, 1]}\n" +
            one_material,
        {"'volume'", "plane stress"});
}

TEST(ReadSimulation, LoadsAreChecked) {
    const std::string base = box_mesh + one_material;
    expect_complaint(base + "[[fix]]\n", {"'where' is missing"});
    expect_complaint(base + "[[fix]]\nwhere = {side = \"top\"}\n", {"'side' is", "z-max"});
    expect_complaint(base + held_base + "components = \"xw\"\n",
                     {"'components'", "letters x, y, z"});
    expect_complaint(base + "[[move]]\nwhere = {side = \"z-max\"}\n", {"x_mm, y_mm, z_mm"});
    expect_complaint(base + "[[move]]\nwhere = {side = \"z-max\"}\nz_mm = 1\ncolumn = \"pull\"\n",
                     {"'column'", "[history]"});
    expect_complaint(base + "[[force]]\nwhere = {side = \"z-max\"}\n", {"total_mn", "nodal_mn"});
    expect_complaint(base + held_base + held_base, {"'base'", "name of its own"});
    expect_complaint(base + "[[fix]]\nwhere = {radius_mm = 2}\n", {"radius_mm", "centre_mm"});
    expect_complaint(base + "[[obstacle]]\nshape = \"cube\"\n", {"'shape'", "cube", "cylinder"});
    expect_complaint(base +
                         "[[obstacle]]\nshape = \"plane\"\nplace_mm = [0, 0, 0]\n"
                         "direction = [0, 0, 1]\nradius_mm = 2\n",
                     {"'radius_mm'", "plane"});
    expect_complaint(
        base + "[[traction]]\nwhere = {side = \"z-max\"}\nkpa = [0, 0, 1]\nfollows = true\n",
        {"[[traction]]", "'follows'"});
    expect_complaint(base + "[[pressure]]\nwhere = {side = \"z-max\"}\nkpa = 1\nfollows = 1\n",
                     {"[[pressure]]", "'follows'"});
}

const std::string ring =
    "[[obstacle]]\nshape = \"tube\"\nplace_mm = [0, 0, 2]\ndirection = [0, 0, -1]\n"
    "hole_radius_mm = 1\nedge_radius_mm = 0.2\nouter_radius_mm = 2\n";
const std::string stamp =
    "[[obstacle]]\nshape = \"punch\"\nplace_mm = [0, 0, 2]\ndirection = [0, 0, -1]\n"
    "radius_mm = 1\nedge_radius_mm = 0.2\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

TEST(ReadSimulation, TubesAndPunchesHaveTheirSizes) {
    const std::string base = box_mesh + one_material;
    const Obstacle tube = parsed(base + ring).obstacles[0].obstacle;
    EXPECT_EQ(tube.shape, ObstacleShape::tube);
    EXPECT_EQ((std::array{tube.radius_mm, tube.edge_radius_mm, tube.outer_radius_mm,
                          tube.outer_edge_radius_mm}),
              (std::array{1.0, 0.2, 2.0, 0.2}));
    EXPECT_EQ(parsed(base + ring + "outer_edge_radius_mm = 0.7\n")
                  .obstacles[0]
                  .obstacle.outer_edge_radius_mm,
              0.7);
    const Obstacle punch = parsed(base + stamp).obstacles[0].obstacle;
    EXPECT_EQ(punch.shape, ObstacleShape::punch);
    EXPECT_EQ((std::array{punch.radius_mm, punch.edge_radius_mm}), (std::array{1.0, 0.2}));
}

TEST(ReadSimulation, SizesOfTubesAndPunchesAreChecked) {
    const std::string base = box_mesh + one_material;
    expect_complaint(base + with(ring, "outer_radius_mm = 2", "outer_radius_mm = 1.3"),
                     {"line 13", "'outer_radius_mm' is 1.3", "1.4 mm", "rim is narrower"});
    expect_complaint(base + with(ring, "edge_radius_mm = 0.2", "edge_radius_mm = 0"),
                     {"line 12", "'edge_radius_mm' is 0", "greater than 0"});
    expect_complaint(base + with(ring, "hole_radius_mm = 1", "hole_radius_mm = -1"),
                     {"line 11", "'hole_radius_mm' is -1", "greater than 0"});
    expect_complaint(base + with(ring, "hole_radius_mm", "radius_mm"),
                     {"'radius_mm'", "a tube has none"});
    expect_complaint(base + ring + "hollow = true\n", {"'hollow'", "a tube has none"});
    expect_complaint(base + with(ring, "outer_radius_mm = 2\n", ""),
                     {"'outer_radius_mm' is missing"});
    expect_complaint(base + with(stamp, "edge_radius_mm = 0.2", "edge_radius_mm = 1.5"),
                     {"'edge_radius_mm' is 1.5", "at most radius_mm, 1 mm"});
    expect_complaint(base + stamp + "outer_radius_mm = 3\n", {"a punch has none"});
}

TEST(ReadSimulation, NewtonAndHistoryAreChecked) {
    const std::string base = box_mesh + one_material;
    expect_complaint(base + "[newton]\nrelative_tolerance = 0\n", {"relative_tolerance"});
    expect_complaint(base + "[newton]\nsmallest_step = 0.5\nfirst_step = 0.1\n",
                     {"'smallest_step'", "first_step (0.1)"});
    expect_complaint(base + "[history]\npull = [1]\n", {"'time_s' is missing"});
    expect_complaint(base + "[history]\ntime_s = [1, 2]\npull = [1]\n", {"'pull'", "2 numbers"});
    expect_complaint(base + "[history]\ntime_s = [2, 1]\n", {"'time_s'", "ascend", "1 after 2"});
    expect_complaint(base +
                         "[history]\ntime_s = [1]\npull = [1]\n[[move]]\nz_mm = 1\n"
                         "where = {side = \"z-max\"}\ncolumn = \"push\"\n",
                     {"'column'", "push", "pull"});
    expect_complaint(base + "[history]\ntime_s = [1]\n[newton]\nload_steps = 3\n", {"load_steps"});
}

TEST(ReadSimulation, TextThatIsNotTomlIsRefusedWithItsLine) {
    expect_refused([] { parsed("[mesh]\nbox = {\n"); }, {"model.toml, line"},
                   ErrorCode::input_unreadable);
    expect_refused([] { read_simulation("/nowhere/model.toml"); }, {"model.toml", "no such file"},
                   ErrorCode::input_unreadable);
}

}  // namespace
}  // namespace palpate

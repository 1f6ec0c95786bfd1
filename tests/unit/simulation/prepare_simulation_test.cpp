// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "host/apps/simulate/selection.hpp"
#include "solver/materials/registry.hpp"
#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

const std::string base = box_mesh + one_material;

/// Sum of the forces of all nodes at full load.
Vec3 total_force(const std::string& toml) {
    const SimulationSettings settings = parsed(toml);
    const Eigen::VectorXd force = prepare_simulation(settings).loads_at(settings, 0).force;
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index d = 0; d < force.size(); ++d) sum[d % 3] += force[d];
    return sum;
}

std::size_t num_prescribed(const PreparedSimulation& p) {
    return static_cast<std::size_t>(
        std::accumulate(p.model.prescribed.begin(), p.model.prescribed.end(), 0));
}

TEST(PrepareSimulation, ASideHoldsItsNodes) {
    const PreparedSimulation p = prepared(base + held_base);

    ASSERT_EQ(p.supports.size(), 1u);
    EXPECT_EQ(p.supports[0].num_nodes, 9);
    EXPECT_EQ(num_prescribed(p), 27u);
}

TEST(PrepareSimulation, SelectionsMeetAllTheirCriteria) {
    const auto count = [](const std::string& where) {
        return prepared(base + "[[fix]]\nwhere = " + where + "\n").supports[0].num_nodes;
    };
    EXPECT_EQ(count("{}"), 18);
    EXPECT_EQ(count("{side = \"z-max\", to_mm = [2, 4, 2]}"), 6);
    EXPECT_EQ(count("{from_mm = [2, 2, 0], to_mm = [2, 2, 0]}"), 1);
    EXPECT_EQ(count("{centre_mm = [0, 0, 0], radius_mm = 2}"), 4);
    EXPECT_EQ(count("{point_mm = [0, 0, 0], normal = [1, -1, 0]}"), 6);
    EXPECT_EQ(count("{point_mm = [0, 0, 0.4], normal = [0, 0, 3], tolerance_mm = 0.5}"), 9);
}

TEST(PrepareSimulation, AnEmptySelectionSaysHowFarTheMeshReaches) {
    expect_refused([] { prepared(base + "[[fix]]\nwhere = {from_mm = [9, 0, 0]}\n"); },
                   {"model.toml, line 8", "no node", "(4, 4, 2)"});
    expect_refused([] { prepared(base + "[[fix]]\nwhere = {point_array = \"wall\"}\n"); },
                   {"'point_array'", "wall", "no point arrays"});
    expect_refused(
        [] {
            prepared(base +
                     "[[pressure]]\nkpa = 1\nwhere = {centre_mm = [2, 2, 0], "
                     "radius_mm = 0.1}\n");
        },
        {"no face"});
}

TEST(PrepareSimulation, LoadsHaveTheirResultants) {
    EXPECT_TRUE(total_force(base + "[[force]]\nwhere = {side = \"z-max\"}\ntotal_mn = [1, 2, 3]\n")
                    .isApprox(Vec3(1, 2, 3)));
    EXPECT_TRUE(total_force(base + "[[force]]\nwhere = {side = \"z-max\"}\nnodal_mn = [1, 0, 0]\n")
                    .isApprox(Vec3(9, 0, 0)));
    EXPECT_TRUE(total_force(base + "[[pressure]]\nwhere = {side = \"z-max\"}\nkpa = 2\n")
                    .isApprox(Vec3(0, 0, -32)));
    EXPECT_TRUE(total_force(base + "[[traction]]\nwhere = {side = \"x-min\"}\nkpa = [0, 3, 1]\n")
                    .isApprox(Vec3(0, 24, 8)));
}

TEST(PrepareSimulation, ColumnsScaleTheirLoads) {
    const SimulationSettings settings =
        parsed(base +
               "[[move]]\nwhere = {side = \"z-max\"}\nz_mm = 2\ncolumn = \"pull\"\n"
               "[[force]]\nwhere = {side = \"x-max\"}\ntotal_mn = [6, 0, 0]\n"
               "[history]\ntime_s = [1, 2]\npull = [0.5, -1]\n");
    const PreparedSimulation p = prepare_simulation(settings);

    EXPECT_DOUBLE_EQ(p.loads_at(settings, 0).displacement.maxCoeff(), 1);
    EXPECT_DOUBLE_EQ(p.loads_at(settings, 1).displacement.minCoeff(), -2);
    for (std::size_t step : {0, 1}) EXPECT_NEAR(p.loads_at(settings, step).force.sum(), 6, 1e-12);
}

TEST(PrepareSimulation, AStaticLoadGrowsInEqualPartsAndForgetsRelaxation) {
    const SimulationSettings settings =
        parsed(base + "relaxation = [{amplitude = 1, time_s = 1}]\n" +
               "[[move]]\nwhere = {side = \"z-max\"}\nz_mm = 2\n[newton]\nload_steps = 4\n");
    const PreparedSimulation p = prepare_simulation(settings);

    ASSERT_EQ(p.time_s.size(), 4u);
    EXPECT_DOUBLE_EQ(p.loads_at(settings, 0).displacement.maxCoeff(), 0.5);
    EXPECT_DOUBLE_EQ(p.loads_at(settings, 3).displacement.maxCoeff(), 2);
    EXPECT_TRUE(p.model.materials[0].relaxation.empty());
}

TEST(PrepareSimulation, TwoSupportsMayAgreeButNotContradict) {
    const std::string corner = "[[move]]\nname = \"corner\"\nwhere = {from_mm = [4, 4, 0]}\n";
    const PreparedSimulation p =
        prepared(base + held_base + "[[fix]]\nwhere = {side = \"x-min\"}\n");

    EXPECT_EQ(p.supports[0].dofs.size() + p.supports[1].dofs.size(), num_prescribed(p));
    expect_refused([&] { prepared(base + held_base + corner + "z_mm = 1\n"); },
                   {"line 10", "corner", "'base'", "component z", "(4, 4, 0)"});
}

TEST(PrepareSimulation, LabelsAndMaterialsMustMatch) {
    const std::string part = "[[mesh.part]]\nregion = 3\nwhere = {to_mm = [2, 4, 2]}\n";
    const std::string three =
        "[[material]]\nregion = 3\nlaw = \"linear\"\nstiffness_kpa = 1\n"
        "poisson_ratio = 0\n";
    const std::string first = one_material + "region = 1\n";
    const PreparedSimulation p = prepared(box_mesh + part + three + first);

    EXPECT_EQ(p.labels, (std::vector<Index>{3, 1}));
    EXPECT_EQ(std::count(p.model.mesh.region.begin(), p.model.mesh.region.end(), 0), 12);
    expect_refused([&] { prepared(box_mesh + part + first); }, {"[mesh]", "label 3", "region = 3"});
    expect_refused([&] { prepared(box_mesh + three + first); }, {"'region' is 3", "no element"});
}

TEST(PrepareSimulation, AMiddleNodeBelongsToASetIfBothEndsDo) {
    const PreparedSimulation p =
        prepared(box_mesh + "quadratic = true\n" + one_material + held_base);

    EXPECT_EQ(p.model.mesh.type, ElementType::tet10);
    EXPECT_EQ(p.supports[0].num_nodes, 25);
}

TEST(PrepareSimulation, AnObstacleIsAHundredTimesAsStiffAsTheStiffestElementItMayTouch) {
    const std::string plate =
        "[[obstacle]]\nname = \"plate\"\nshape = \"plane\"\n"
        "place_mm = [0, 0, 2.5]\ndirection = [0, 0, -1]\n"
        "motion_mm = [0, 0, -1]\nwhere = {side = \"z-max\"}\n";
    const SimulationSettings settings = parsed(base + plate);
    const PreparedSimulation p = prepare_simulation(settings);

    ASSERT_EQ(p.model.contacts.size(), 1u);
    EXPECT_EQ(p.model.contacts[0].faces.size(), 8u);
    const double edge_mm = (2 + 2 + std::sqrt(8)) / 3;
    EXPECT_NEAR(p.model.contacts[0].stiffness_kpa_per_mm, 100 * 10 / edge_mm, 1e-9);
    // At once the shear modulus is twice as high, the bulk modulus is not, unless all relaxes.
    const auto stiffness_with = [&](const std::string& how) {
        return prepared(box_mesh + one_material + "relaxation = [{amplitude = 1, time_s = 1}]\n" +
                        how + held_base + plate +
                        "column = \"a\"\n[history]\ntime_s = [1]\na = [1]\n")
            .model.contacts[0]
            .stiffness_kpa_per_mm;
    };
    const double shear = 10 / 2.6, bulk = 10 / 1.2;
    const double sudden = 9 * bulk * 2 * shear / (3 * bulk + 2 * shear);
    EXPECT_NEAR(stiffness_with(""), 100 * sudden / edge_mm, 1e-9);
    EXPECT_NEAR(stiffness_with("relaxation_of = \"total\"\n"), 100 * 20 / edge_mm, 1e-9);
    EXPECT_NEAR(stiffness_with("instantaneous = true\n"), 100 * 10 / edge_mm, 1e-9);
    EXPECT_EQ(p.loads_at(settings, 0).obstacle_motion, (std::vector<Vec3>{Vec3(0, 0, -1)}));
    const std::string friction = plate + "stiffness_kpa_per_mm = 7\nfriction = 0.3\n";
    EXPECT_DOUBLE_EQ(prepared(base + friction).model.contacts[0].slip_stiffness_kpa_per_mm, 7);
    expect_refused(
        [&] {
            prepared(
                "[mesh]\nformulation = \"axisymmetric\"\nrectangle = {size_mm = "
                "[1, 1], divisions = [1, 1]}\n" +
                one_material +
                "[[obstacle]]\n"
                "shape = \"plane\"\nplace_mm = [0, 0]\ndirection = [0, 0, 1]\n");
        },
        {"line 8", "[[obstacle]]", "normal"});
}

TEST(PrepareSimulation, AFollowingPressureIsALoadOfTheModelThatItsColumnScales) {
    const SimulationSettings settings = parsed(
        base +
        "[[pressure]]\nwhere = {side = \"z-max\"}\nkpa = 2\n"
        "[[pressure]]\nwhere = {side = \"x-max\"}\nkpa = -3\nfollows = true\ncolumn = \"suck\"\n"
        "[history]\ntime_s = [1, 2]\nsuck = [0.5, -1]\n");
    const PreparedSimulation p = prepare_simulation(settings);

    ASSERT_EQ(p.model.pressures.size(), 1u);
    EXPECT_EQ(p.model.pressures[0].faces.size(), 4u);
    EXPECT_EQ(p.loads_at(settings, 0).pressure_kpa, (std::vector<double>{-1.5}));
    EXPECT_EQ(p.loads_at(settings, 1).pressure_kpa, (std::vector<double>{3}));
    EXPECT_NEAR(p.loads_at(settings, 1).force.sum(), -32, 1e-12);
}

TEST(PrepareSimulation, AboutAnAxisATubeStandsOnIt) {
    const auto with_tube = [](const std::string& place, const std::string& more) {
        return "[mesh]\nformulation = \"axisymmetric\"\nrectangle = {size_mm = [4, 2], divisions = "
               "[4, 2]}\n" +
               one_material +
               "[[obstacle]]\nshape = \"tube\"\ndirection = [0, -1]\nhole_radius_mm = 1\n"
               "edge_radius_mm = 0.2\nouter_radius_mm = 3\nplace_mm = " +
               place + "\n" + more;
    };
    EXPECT_EQ(prepared(with_tube("[0, 2]", "motion_mm = [0, -1]\n")).model.contacts.size(), 1u);
    expect_refused([&] { prepared(with_tube("[1, 2]", "")); },
                   {"line 8", "[[obstacle]]", "tube", "x = 0"});
    expect_refused([&] { prepared(with_tube("[0, 2]", "motion_mm = [1, -1]\n")); },
                   {"line 8", "[[obstacle]]", "motion_mm needs x = 0"});
}

TEST(PrepareSimulation, APlaneMeshIsNotPulledOutOfItsPlane) {
    const std::string plane =
        "[mesh]\nformulation = \"plane-strain\"\nrectangle = {size_mm = [1, 1]"
        ", divisions = [1, 1]}\n" +
        one_material;
    expect_refused([&] { prepared(plane + "[[move]]\nwhere = {side = \"x-max\"}\nz_mm = 1\n"); },
                   {"line 8", "plane"});
    EXPECT_EQ(num_prescribed(prepared(plane + "[[fix]]\nwhere = {side = \"x-min\"}\n")), 4u + 4u);
}

}  // namespace
}  // namespace palpate

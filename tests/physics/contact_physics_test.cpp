// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "solver/equilibrium/time_steps.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

Contact plane_above(const SolidMesh& mesh, double height_mm) {
    Contact contact;
    contact.obstacle.place.z() = height_mm;
    contact.obstacle.direction = -Vec3::UnitZ();
    contact.faces =
        boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].z() > height_mm - 1e-9; });
    return contact;
}

/// A cube of 2 mm under a plate.
fixtures::LoadedModel cube_under_plate(const SolidMaterial& material, double shear_hold) {
    const SolidMesh mesh = solid_mesh_of(fixtures::box_mesh({3, 3, 3}, Vec3(2, 2, 2)));
    fixtures::LoadedModel work{fixtures::solid_model(mesh, material), {}};
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const Vec3& at = mesh.nodes[n];
        if (at.z() < 1e-9) work.model.prescribed[3 * n + 2] = 1;
        if (at.z() < 1e-9 && shear_hold > 0) std::fill_n(&work.model.prescribed[3 * n], 3, 1);
        if (at.x() < 1e-9 && shear_hold == 0) work.model.prescribed[3 * n] = 1;
        if (at.y() < 1e-9 && shear_hold == 0) work.model.prescribed[3 * n + 1] = 1;
    }
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setZero(work.model.num_dofs());
    work.model.contacts = {plane_above(mesh, 2)};
    return work;
}

// The plate's springs and the cube carry the same pressure: p = k (d - s) = E s / h.
TEST(ContactPhysics, APlateAndACubeAreSpringsInSeries) {
    fixtures::LoadedModel work = cube_under_plate({"linear", {10, 0.3}}, 0);
    work.model.contacts[0].stiffness_kpa_per_mm = 40;
    work.loads.obstacle_motion = {Vec3(0, 0, -0.2)};
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
    ASSERT_TRUE(found.converged) << found.message;
    const double pressure = 0.2 / (2.0 / 10 + 1.0 / 40);
    EXPECT_NEAR(found.contact.force[0].z(), -4 * pressure, 1e-8 * 4 * pressure);
    EXPECT_NEAR(found.contact.depth_mm[0], pressure / 40, 1e-9);
}

TEST(ContactPhysics, APlateThatLeavesDoesNotPull) {
    fixtures::LoadedModel work = cube_under_plate({"neo-hookean", {10, 0.3}}, 0);
    work.model.contacts[0].stiffness_kpa_per_mm = 40;
    std::vector<LoadTime> times(2, {1, work.loads});
    times[0].loads.obstacle_motion = {Vec3(0, 0, -0.2)};
    times[1].time_s = 2;
    times[1].loads.obstacle_motion = {Vec3(0, 0, 0.2)};
    const auto states = solve_history(work.model, times, {});
    ASSERT_TRUE(states.size() == 2 && states[1].converged);
    EXPECT_LT(states[0].contact.force[0].z(), -1);
    EXPECT_EQ(states[1].contact.force[0].norm(), 0);
    EXPECT_LT(states[1].displacement.norm(), 1e-8);
}

// Pressed, then dragged: the plate sticks, then slips with Coulomb's force, wherever it goes.
TEST(ContactPhysics, ADraggedPlateSlipsWithCoulombsForce) {
    fixtures::LoadedModel work = cube_under_plate({"neo-hookean", {10, 0.3}}, 1);
    Contact& plate = work.model.contacts[0];
    plate.stiffness_kpa_per_mm = 200;
    plate.slip_stiffness_kpa_per_mm = 200;
    plate.friction = 0.25;
    std::vector<LoadTime> times;
    for (int k = 0; k < 6; ++k) {
        times.push_back({k + 1.0, work.loads});
        times.back().loads.obstacle_motion = {Vec3(0.15 * k, 0.1 * k, -0.2)};
    }
    const auto states = solve_history(work.model, times, {});
    ASSERT_EQ(states.size(), 6u);
    double before = -1;
    for (const Equilibrium& state : states) {
        ASSERT_TRUE(state.converged) << state.message;
        const Vec3 force = state.contact.force[0];
        const double ratio = std::hypot(force.x(), force.y()) / -force.z();
        EXPECT_GE(ratio, before - 1e-9);
        EXPECT_LE(ratio, 0.25 * (1 + 1e-9));
        before = ratio;
    }
    // The mesh leans a little, so pressing alone drags a little.
    const Vec3 first = states[0].contact.force[0];
    EXPECT_LT(std::hypot(first.x(), first.y()), 0.02 * -first.z());
    EXPECT_NEAR(before, 0.25, 1e-7);
    const Vec3 last = states.back().contact.force[0];
    EXPECT_NEAR(last.y() / last.x(), 0.1 / 0.15, 0.02);
    // What the plate does, the floor answers.
    Vec3 floor = Vec3::Zero();
    for (Index n = 0; n < work.model.mesh.num_nodes(); ++n)
        floor += states.back().reaction.segment<3>(3 * n);
    EXPECT_LT((floor + last).norm(), 1e-6 * last.norm());
}

// Enough friction and stiffness: as if the plate were glued on.
TEST(ContactPhysics, APlateThatSticksMovesItsFaceAlong) {
    fixtures::LoadedModel work = cube_under_plate({"neo-hookean", {10, 0.3}}, 1);
    Contact& plate = work.model.contacts[0];
    plate.stiffness_kpa_per_mm = 2e4;
    plate.slip_stiffness_kpa_per_mm = 2e4;
    plate.friction = 5;
    work.loads.obstacle_motion = {Vec3(0.1, 0, -0.3)};
    const Equilibrium held = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
    ASSERT_TRUE(held.converged) << held.message;

    SolidModel bare = work.model;
    bare.contacts.clear();
    const fixtures::LoadedModel glued = fixtures::between_plates(bare, Vec3(0.1, 0, -0.3));
    const Equilibrium expected = solve_equilibrium(SolidAssembly(glued.model), glued.loads, {});
    EXPECT_LT((held.displacement - expected.displacement).norm(),
              0.01 * expected.displacement.norm());
}

/// Places that stand close together near 0.
double graded(double part, double size_mm) { return size_mm * std::pow(part, 3); }

// Hertz (Johnson 1985, section 4.2): F = 4/3 E / (1 - nu^2) sqrt(R) d^(3/2) on a half-space; the
// body here is a hundred and fifty times as large as the contact, which is a fortieth of the
// sphere: wider ones are stiffer, as the surface moves inwards under them.
TEST(ContactPhysics, ARigidSphereFollowsHertz) {
    SolidMesh mesh = fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric,
                                              {64, 64}, {1.0, 1.0});
    for (Vec3& node : mesh.nodes) node = Vec3(graded(node.x(), 150), -graded(1 - node.y(), 150), 0);
    SolidModel model = fixtures::solid_model(mesh, {"linear", {10, 0.3}});
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n].y() < -150 + 1e-9) model.prescribed[3 * n + 1] = 1;
    Contact contact;
    contact.obstacle.shape = ObstacleShape::sphere;
    contact.obstacle.radius_mm = 40;
    contact.obstacle.place = Vec3(0, 40, 0);
    contact.stiffness_kpa_per_mm = 5e4;
    contact.faces = boundary_faces(
        mesh, [&](Index n) { return mesh.nodes[n].y() > -1e-9 && mesh.nodes[n].x() < 4; });
    model.contacts = {contact};
    SolidLoads loads;
    loads.displacement.setZero(model.num_dofs());
    loads.force.setZero(model.num_dofs());
    loads.obstacle_motion = {Vec3(0, -0.025, 0)};
    const Equilibrium found = solve_equilibrium(SolidAssembly(model), loads, {});
    ASSERT_TRUE(found.converged) << found.message;
    const double expected = 4.0 / 3 * 10 / (1 - 0.09) * std::sqrt(40) * std::pow(0.025, 1.5);
    EXPECT_NEAR(-found.contact.force[0].y(), expected, 0.03 * expected);
}

}  // namespace
}  // namespace palpate

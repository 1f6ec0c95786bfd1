// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "solver/equilibrium/time_steps.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using fixtures::LoadedModel;

/// A block whose lower face is held, or a cylinder of it about an axis, and what may touch its top.
LoadedModel block_under(const SolidMesh& mesh, const Obstacle& obstacle) {
    LoadedModel work{fixtures::solid_model(mesh, {"neo-hookean", {10, 0.4}}), {}};
    const int up = mesh.formulation == Formulation::solid ? 2 : 1;
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n][up] < 1e-9) std::fill_n(&work.model.prescribed[3 * n], 3, 1);
    Contact contact;
    contact.obstacle = obstacle;
    contact.obstacle.place = 2 * Vec3::Unit(up);
    contact.obstacle.direction = -Vec3::Unit(up);
    contact.faces = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n][up] > 2 - 1e-9; });
    contact.stiffness_kpa_per_mm = contact.slip_stiffness_kpa_per_mm = 200;
    contact.friction = 0.2;
    work.model.contacts = {contact};
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setZero(work.model.num_dofs());
    work.loads.obstacle_motion = {-0.3 * Vec3::Unit(up)};
    return work;
}

std::vector<SolidMesh> blocks() {
    return {solid_mesh_of(fixtures::box_mesh({3, 3, 3}, Vec3(2, 2, 2))),
            fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric, {6, 4},
                                     {3.0, 2.0})};
}

Obstacle punch(double radius_mm, double edge_radius_mm) {
    Obstacle obstacle;
    obstacle.shape = ObstacleShape::punch;
    obstacle.radius_mm = radius_mm;
    obstacle.edge_radius_mm = edge_radius_mm;
    return obstacle;
}

TEST(TubePhysics, APunchWiderThanTheBodyIsAPlane) {
    for (const SolidMesh& mesh : blocks()) {
        const LoadedModel by_plane = block_under(mesh, Obstacle{});
        const LoadedModel by_punch = block_under(mesh, punch(50, 1));
        const auto plane = solve_equilibrium(SolidAssembly(by_plane.model), by_plane.loads, {});
        const auto punched = solve_equilibrium(SolidAssembly(by_punch.model), by_punch.loads, {});
        ASSERT_TRUE(plane.converged && punched.converged);
        EXPECT_GT(plane.contact.force[0].norm(), 1);
        EXPECT_LE((plane.displacement - punched.displacement).norm(),
                  1e-12 * plane.displacement.norm());
        EXPECT_LE((plane.contact.force[0] - punched.contact.force[0]).norm(),
                  1e-12 * plane.contact.force[0].norm());
    }
}

TEST(TubePhysics, APunchLetsGo) {
    for (const SolidMesh& mesh : blocks()) {
        LoadedModel work = block_under(mesh, punch(0.8, 0.3));
        work.model.contacts[0].friction = 0;
        std::vector<LoadTime> times{{1, work.loads}, {2, work.loads}};
        for (Vec3& by : times[1].loads.obstacle_motion) by = -by;
        const auto states = solve_history(work.model, times, {});
        ASSERT_TRUE(states.size() == 2 && states[1].converged);
        EXPECT_GT(states[0].contact.force[0].norm(), 1);
        EXPECT_EQ(states[1].contact.force[0].norm(), 0);
        EXPECT_LT(states[1].displacement.norm(), 1e-7);
    }
}

/// Of `count` parts, the first `even` as long as `first_mm`, the others longer and longer up to the
/// end: the place of line k.
double graded_line(Index k, Index even, Index count, double first_mm, double end_mm) {
    if (k <= even) return k * first_mm;
    double low = 1, high = 3;
    const auto reach = [&](double ratio, Index steps) {
        return ratio * (std::pow(ratio, steps) - 1) / (ratio - 1) * first_mm;
    };
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (reach(middle, count - even) < end_mm - even * first_mm ? low : high) = middle;
    }
    return even * first_mm + reach(low, k - even);
}

/// A body about an axis, fine near the axis and under its surface at y = 0.
SolidMesh half_space(Index even, Index outer, Index layers, double first_mm, double width_mm,
                     double depth_mm) {
    const Index columns = even + outer;
    SolidMesh mesh = fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric,
                                              {columns, layers}, {1.0, 1.0});
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const Index i = n % (columns + 1), j = n / (columns + 1);
        mesh.nodes[n] = Vec3(graded_line(i, even, columns, first_mm, width_mm),
                             -graded_line(layers - j, 0, layers, 1.2 * first_mm, depth_mm), 0);
    }
    return mesh;
}

SolidModel held_below(const SolidMesh& mesh, double depth_mm, const SolidMaterial& material) {
    SolidModel model = fixtures::solid_model(mesh, material);
    model.volume = VolumeTreatment::element_mean;
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n].y() < -depth_mm + 1e-6) std::fill_n(&model.prescribed[3 * n], 3, 1);
    return model;
}

SolidLoads no_loads(const SolidModel& model) {
    SolidLoads loads;
    loads.displacement.setZero(model.num_dofs());
    loads.force.setZero(model.num_dofs());
    return loads;
}

// Sneddon 1965: a flat punch of radius a sinks into a half-space by d under F = 2 a E / (1 - nu^2)
// d.
TEST(TubePhysics, AFlatPunchFollowsSneddon) {
    constexpr double depth_mm = 150, radius_mm = 2.025, edge_mm = 0.05;
    const SolidMesh mesh = half_space(40, 40, 50, 0.0625, 150, depth_mm);
    SolidModel model = held_below(mesh, depth_mm, {"linear", {10, 0.3}});
    Contact contact;
    contact.obstacle = punch(radius_mm, edge_mm);
    contact.obstacle.direction = -Vec3::UnitY();
    contact.stiffness_kpa_per_mm = 5e4;
    contact.faces = boundary_faces(
        mesh, [&](Index n) { return mesh.nodes[n].y() > -1e-9 && mesh.nodes[n].x() < 3; });
    model.contacts = {contact};
    SolidLoads loads = no_loads(model);
    loads.obstacle_motion = {Vec3(0, -0.01, 0)};
    const Equilibrium found = solve_equilibrium(SolidAssembly(model), loads, {});
    ASSERT_TRUE(found.converged) << found.message;
    const double expected = 2 * (radius_mm - edge_mm / 2) * 10 / (1 - 0.09) * 0.01;
    EXPECT_NEAR(-found.contact.force[0].y(), expected, 0.03 * expected);
}

/// Phi of E = 3 Phi P a / (2 pi L): the apex L of soft tissue 50 mm wide and 40 mm deep in a tube
/// of hole radius a = 5 mm (Theret et al. 1988).
double wall_function(double edge_mm, double first_mm) {
    constexpr double hole_mm = 5, depth_mm = 40, stiffness_kpa = 4, suction_kpa = 0.02;
    const auto even = static_cast<Index>(std::lround((hole_mm + edge_mm) / first_mm));
    const SolidMesh mesh = half_space(even, 30, 36, (hole_mm + edge_mm) / even, 50, depth_mm);
    // At these strains the law is linear; nearly incompressible.
    SolidModel model = held_below(
        mesh, depth_mm, {"neo-hookean-reduced", {stiffness_kpa / 6, 1e3 * stiffness_kpa}});
    Contact contact;
    contact.obstacle.shape = ObstacleShape::tube;
    contact.obstacle.direction = -Vec3::UnitY();
    contact.obstacle.radius_mm = hole_mm;
    contact.obstacle.edge_radius_mm = edge_mm;
    contact.obstacle.outer_radius_mm = 10;
    contact.obstacle.outer_edge_radius_mm = edge_mm;
    contact.stiffness_kpa_per_mm = 200 * stiffness_kpa / first_mm;
    const auto is_top = [&](Index n) { return mesh.nodes[n].y() > -1e-9; };
    contact.faces = boundary_faces(mesh, is_top);
    model.contacts = {contact};
    model.pressures = {{boundary_faces(
        mesh, [&](Index n) { return is_top(n) && mesh.nodes[n].x() < hole_mm + edge_mm + 1e-9; })}};
    SolidLoads loads = no_loads(model);
    loads.pressure_kpa = {-suction_kpa};
    const Equilibrium found = solve_equilibrium(SolidAssembly(model), loads, {});
    EXPECT_TRUE(found.converged) << found.message;
    double apex_mm = 0;
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (is_top(n) && mesh.nodes[n].x() == 0) apex_mm = found.displacement[3 * n + 1];
    // What the tube pushes down is what the suction pulls up and the bottom does not hold.
    EXPECT_LT(found.contact.force[0].y(), 0);
    return 2 * std::numbers::pi * stiffness_kpa * apex_mm / (3 * suction_kpa * hole_mm);
}

TEST(TubePhysics, ALittleSuctionLiftsTheApexAsTheret) {
    const double coarse = wall_function(0.2, 0.2), fine = wall_function(0.2, 0.1);
    std::printf("Phi at an edge of 0.2 mm: %.4f, on half the mesh width %.4f\n", coarse, fine);
    EXPECT_GT(fine, 2.00);
    EXPECT_LT(fine, 2.10);
    EXPECT_NEAR(coarse, fine, 0.02);
    const double sharp = wall_function(0.05, 0.1);
    std::printf("Phi at an edge of 0.05 mm: %.4f\n", sharp);
    EXPECT_LT(sharp, fine);
    EXPECT_NEAR(sharp, 2.0, 0.05);
}

}  // namespace
}  // namespace palpate

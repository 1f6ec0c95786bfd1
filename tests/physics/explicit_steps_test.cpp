// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/explicit_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"
#include "solver/equilibrium/lumped_mass.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using fixtures::LoadedModel;

LoadedModel bar_of(const SolidMaterial& material) {
    const SolidMesh mesh = fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric,
                                                    {2, 40}, {1.0, 20.0});
    LoadedModel work{fixtures::solid_model(mesh, material), {}};
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n].y() < 1e-9) work.model.prescribed[3 * n + 1] = 1;
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setZero(work.model.num_dofs());
    return work;
}

TEST(LumpedMass, IsThatOfTheBodyAndPositiveForEveryElement) {
    for (const SolidMesh& mesh : fixtures::solid_meshes()) {
        const Eigen::VectorXd mass = lumped_mass(mesh, 1050);
        double volume = 0;
        for (const PointGeometry& point : point_geometry(mesh)) volume += point.volume;
        EXPECT_NEAR(mass.sum(), 1050e-9 * volume, 1e-12 * volume) << mesh.table().name;
        EXPECT_GT(mass.minCoeff(), 0) << mesh.table().name;
    }
}

// A load that is suddenly there swings the end to twice its place at rest after half a period
// T = 4 L / c, c = sqrt(E / density); E 10 kPa and 1000 kg/m^3 make c = 3162 mm/s.
TEST(ExplicitSteps, ABarSwingsToTwiceItsPlaceAtRestInHalfAPeriod) {
    LoadedModel work = bar_of({"linear", {10, 0.0}});
    const SolidMesh& mesh = work.model.mesh;
    const auto end = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].y() > 20 - 1e-9; });
    work.loads.force = traction_forces(
        mesh, end, [](const Vec3&, const Vec3& normal) { return Vec3(0.01 * normal); });
    const double half_period_s = 2 * 20 / std::sqrt(10e6);
    std::vector<LoadTime> times{{1e-6, work.loads}};
    for (int k = 1; k <= 40; ++k) times.push_back({2 * half_period_s * k / 40, work.loads});
    const ExplicitHistory found = solve_explicit(work.model, times, {});
    ASSERT_TRUE(found.is_complete) << found.message;
    const Index tip = 3 * (mesh.num_nodes() - 1) + 1;
    double farthest = 0, at_s = 0;
    for (const DynamicState& state : found.states)
        if (state.displacement[tip] > farthest) {
            farthest = state.displacement[tip];
            at_s = state.time_s;
        }
    EXPECT_NEAR(farthest, 2 * 0.01 / 10 * 20, 0.03 * 0.04);
    EXPECT_NEAR(at_s, half_period_s, 0.06 * half_period_s);
}

TEST(ExplicitSteps, EnergyIsNeitherMadeNorLost) {
    LoadedModel work = bar_of({"neo-hookean", {10, 0.3}});
    const SolidMesh& mesh = work.model.mesh;
    const auto end = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].y() > 20 - 1e-9; });
    work.loads.force = traction_forces(
        mesh, end, [](const Vec3&, const Vec3& normal) { return Vec3(0.5 * normal); });
    std::vector<LoadTime> times{{1e-6, work.loads}};
    for (int k = 1; k <= 20; ++k) times.push_back({2e-3 * k, work.loads});
    const ExplicitHistory found = solve_explicit(work.model, times, {});
    ASSERT_TRUE(found.is_complete) << found.message;
    double most_work = 0;
    for (const DynamicState& state : found.states)
        most_work = std::max(most_work, work.loads.force.dot(state.displacement));
    for (const DynamicState& state : found.states) {
        const double total = state.stored_energy + state.kinetic_energy;
        EXPECT_NEAR(total, work.loads.force.dot(state.displacement), 0.03 * most_work)
            << state.time_s;
    }
}

// Relaxation, friction and all: once motion has died down, that is equilibrium.
TEST(ExplicitSteps, DampedMotionEndsInEquilibrium) {
    const SolidMesh mesh = solid_mesh_of(fixtures::box_mesh({2, 2, 2}, Vec3(2, 2, 2)));
    for (const SolidMaterial& bare : fixtures::solid_materials()) {
        SolidMaterial material = bare;
        material.relaxation = {{0.5, 0.002}};
        material.relaxation_of = RelaxationOf::isochoric;
        LoadedModel work = fixtures::pulled(fixtures::solid_model(mesh, material));
        Contact contact;
        contact.obstacle.place.z() = 2;
        contact.obstacle.direction = -Vec3::UnitZ();
        contact.stiffness_kpa_per_mm = 40;
        contact.faces = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].z() > 2 - 1e-9; });
        work.model.contacts = {contact};
        work.loads.obstacle_motion = {Vec3(0, 0, -0.2)};
        ExplicitOptions options;
        options.damping_per_s = 800;
        const ExplicitHistory found =
            solve_explicit(work.model, {{0.01, work.loads}, {0.08, work.loads}}, options);
        ASSERT_TRUE(found.is_complete) << material.law << ": " << found.message;
        work.model.materials[0].relaxation.clear();
        const Equilibrium expected = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
        EXPECT_LT((found.states.back().displacement - expected.displacement).norm(),
                  1e-4 * expected.displacement.norm())
            << material.law;
        EXPECT_NEAR(found.states.back().contact.force[0].z(), expected.contact.force[0].z(),
                    1e-3 * std::abs(expected.contact.force[0].z()))
            << material.law;
    }
}

TEST(ExplicitSteps, WhatCannotBeSteppedIsRefused) {
    const LoadedModel work = fixtures::pulled(fixtures::solid_models()[2]);
    const std::vector<LoadTime> times{{1, work.loads}};
    EXPECT_THROW(solve_explicit(work.model, times, {.density_kg_per_m3 = 0}), Error);
    EXPECT_THROW(solve_explicit(work.model, times, {.safety = 1.2}), Error);
    EXPECT_THROW(solve_explicit(work.model, times, {.damping_per_s = -1}), Error);
    EXPECT_THROW(solve_explicit(work.model, times, {.most_steps = 10}), Error);
    EXPECT_THROW(solve_explicit(work.model, {{1, {}}}, {}), Error);
}

}  // namespace
}  // namespace palpate

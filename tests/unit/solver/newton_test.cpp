// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/newton.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "solver/base/error.hpp"
#include "solver/linear/factor_libraries.hpp"
#include "solver/model/surface_load.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using namespace fixtures;

/// Nodes on the outside of the box or rectangle.
bool is_outside(const SolidMesh& mesh, Index node) {
    const Vec3& x = mesh.nodes[node];
    const bool is_plane = mesh.formulation != Formulation::solid;
    const Vec3 size = is_plane ? Vec3(3, 2, 0) : Vec3(2, 2, 2);
    for (int i = 0; i < (is_plane ? 2 : 3); ++i)
        if (std::abs(x[i]) < 1e-9 || std::abs(x[i] - size[i]) < 1e-9) return true;
    return false;
}

TEST(Equilibrium, AnAffineBoundaryGivesAnAffineInside) {
    const Mat3 slope = (Mat3() << 0.15, 0.1, 0.05, -0.1, -0.12, 0.08, 0.02, 0.05, 0.1).finished();
    for (SolidModel model : solid_models()) {
        const SolidMesh& mesh = model.mesh;
        if (mesh.formulation == Formulation::axisymmetric) continue;
        SolidLoads loads{Eigen::VectorXd::Zero(model.num_dofs()),
                         Eigen::VectorXd::Zero(model.num_dofs())};
        for (Index n = 0; n < mesh.num_nodes(); ++n) {
            Vec3 u = slope * mesh.nodes[n];
            if (mesh.formulation != Formulation::solid) u.z() = 0;
            loads.displacement.segment<3>(3 * n) = u;
            if (is_outside(mesh, n)) std::fill_n(&model.prescribed[3 * n], 3, 1);
        }
        const Equilibrium found = solve_equilibrium(SolidAssembly(model), loads, {});
        ASSERT_TRUE(found.converged) << name_of(model) << ": " << found.message;
        EXPECT_LT((found.displacement - loads.displacement).cwiseAbs().maxCoeff(), 1e-9)
            << name_of(model);
    }
}

/// Norm of the forces that nothing balances, over that of all.
double imbalance(const LoadedModel& work, const Equilibrium& found) {
    Eigen::VectorXd force = SolidAssembly(work.model).internal_force(found.displacement).force;
    const double scale = force.norm();
    force -= found.load * work.loads.force;
    for (Index d = 0; d < work.model.num_dofs(); ++d)
        if (work.model.prescribed[d]) force[d] = 0;
    return force.norm() / scale;
}

TEST(Equilibrium, AHeavyLoadIsReached) {
    for (std::size_t k = 1; k < solid_materials().size(); ++k) {
        const LoadedModel work = between_plates(
            solid_model(solid_meshes()[0], solid_materials()[k]), Vec3(0, 0, -1.5));  // 75 %
        const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
        ASSERT_TRUE(found.converged) << solid_materials()[k].law << ": " << found.message;
        EXPECT_LT(imbalance(work, found), 1e-8) << solid_materials()[k].law;
        EXPECT_LT(found.records.back().relative_residual, 1e-9);
    }
}

TEST(Equilibrium, LoadStepsGrowAndEndWhereOneStepEnds) {
    const LoadedModel work =
        between_plates(solid_model(solid_meshes()[0], solid_materials()[1]), Vec3(0, 0, -0.5));
    EquilibriumOptions options;
    const Equilibrium at_once = solve_equilibrium(SolidAssembly(work.model), work.loads, options);
    options.first_step = 0.25;
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, options);
    ASSERT_TRUE(found.converged) << found.message;
    std::set<double> loads;
    for (const NewtonRecord& record : found.records) loads.insert(record.load);
    EXPECT_EQ(loads, (std::set<double>{0.25, 0.625, 1}));
    EXPECT_LT((found.displacement - at_once.displacement).norm(), 1e-8);
}

TEST(Equilibrium, ARigidTranslationNeedsNoForce) {
    for (const SolidMaterial& material : solid_materials()) {
        const LoadedModel work =
            between_plates(solid_model(solid_meshes()[0], material), Vec3(0.13, 0.07, -0.3), true);
        const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
        EXPECT_TRUE(found.converged) << material.law << ": " << found.message;
        EXPECT_LT(found.reaction.norm(), 1e-10);
    }
}

// Dead loads of a third of the shear modulus and more, from where Newton alone loses its way.
TEST(Equilibrium, ALargePressureIsReachedThroughTangentsThatAreNotDefinite) {
    for (const std::string& library : sparse_factor_names())
        for (const double pressure : {5.0, 30.0}) {
            LoadedModel work =
                between_plates(solid_model(solid_meshes()[0], solid_materials()[1]), Vec3::Zero());
            for (Index n = 0; n < work.model.mesh.num_nodes(); ++n)
                if (work.model.mesh.nodes[n].z() > 1)
                    std::fill_n(&work.model.prescribed[3 * n], 3, 0);
            const auto top = boundary_faces(
                work.model.mesh, [&](Index n) { return work.model.mesh.nodes[n].z() > 2 - 1e-9; });
            work.loads.force = traction_forces(
                work.model.mesh, top, [&](const Vec3&, const Vec3& n) { return -pressure * n; });
            EquilibriumOptions options;
            options.linear.direct_library = library;
            const Equilibrium found =
                solve_equilibrium(SolidAssembly(work.model), work.loads, options);
            ASSERT_TRUE(found.converged)
                << pressure << " kPa, " << library << ": " << found.message;
            EXPECT_LT(imbalance(work, found), 1e-8);
        }
}

TEST(Equilibrium, ReactionsBalanceForcesThatReachOntoTheClamp) {
    LoadedModel work = pulled(solid_model(solid_meshes()[0], solid_materials()[1]));
    const auto side = boundary_faces(work.model.mesh,
                                     [&](Index n) { return work.model.mesh.nodes[n].y() < 1e-9; });
    work.loads.force = traction_forces(work.model.mesh, side,
                                       [](const Vec3&, const Vec3& n) { return Vec3(-0.2 * n); });
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
    ASSERT_TRUE(found.converged) << found.message;
    Vec3 sum = Vec3::Zero();
    for (Index n = 0; n < work.model.mesh.num_nodes(); ++n)
        sum += found.reaction.segment<3>(3 * n) + work.loads.force.segment<3>(3 * n);
    EXPECT_LT(sum.norm(), 1e-8 * found.reaction.norm());
}

TEST(Equilibrium, WhatCannotBeReachedIsSaidAndTheLastEquilibriumKept) {
    const LoadedModel work = between_plates(solid_model(solid_meshes()[0], solid_materials()[1]),
                                            Vec3(0, 0, -2.5));  // through the floor
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
    EXPECT_FALSE(found.converged);
    EXPECT_GT(found.load, 0.3);
    EXPECT_LT(found.load, 0.8);
    EXPECT_NE(found.message.find("% of the load"), std::string::npos);
    std::set<double> loads;
    for (const NewtonRecord& record : found.records) loads.insert(record.load);
    EXPECT_GE(loads.size(), 3u);  // halved, and again
    EXPECT_LT(imbalance(work, found), 1e-8);
}

TEST(Equilibrium, ABodyThatIsNotHeldIsSaid) {
    LoadedModel work{solid_model(solid_meshes()[0], solid_materials()[1]), {}};
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setOnes(work.model.num_dofs());
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
    EXPECT_FALSE(found.converged);
}

TEST(Equilibrium, OptionsOutOfRangeAreRefused) {
    const LoadedModel work =
        between_plates(solid_model(solid_meshes()[0], solid_materials()[1]), Vec3(0, 0, -0.1));
    EquilibriumOptions options;
    options.smallest_step = 0;
    EXPECT_THROW(solve_equilibrium(SolidAssembly(work.model), work.loads, options), Error);
    options = {};
    options.max_newton_steps = 0;
    EXPECT_THROW(solve_equilibrium(SolidAssembly(work.model), work.loads, options), Error);
}

TEST(Equilibrium, LoadsOfTheWrongSizeOrThatAreNoNumbersAreRefused) {
    const SolidModel model = solid_model(solid_meshes()[0], solid_materials()[1]);
    const SolidAssembly solid(model);
    SolidLoads loads{Eigen::VectorXd::Zero(3), Eigen::VectorXd::Zero(model.num_dofs())};
    EXPECT_THROW(solve_equilibrium(solid, loads, {}), Error);
    loads.displacement.setZero(model.num_dofs());
    EXPECT_THROW(solve_equilibrium(solid, loads, {}, {Eigen::VectorXd::Zero(3), {}}), Error);
    loads.displacement.setConstant(model.num_dofs(), std::nan(""));
    EXPECT_THROW(solve_equilibrium(solid, loads, {}), Error);
}

}  // namespace
}  // namespace palpate

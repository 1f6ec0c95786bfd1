// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "solver/adjoint/solid_adjoint.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/newton.hpp"
#include "solver/linear/sparse_factor.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/surface_load.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

const std::vector<SolidMaterial>& materials() {
    static const std::vector<SolidMaterial> list{{"linear", {10, 0.3}},
                                                 {"neo-hookean", {10, 0.35}},
                                                 {"neo-hookean-reduced", {2, 20}},
                                                 {"veronda-westmann", {1.5, 3, 25}},
                                                 {"reduced-polynomial", {1.5, 2, 0.1}}};
    return list;
}

std::vector<SolidMesh> meshes() {
    Mesh box = fixtures::box_mesh({2, 2, 2}, Vec3(2, 2, 2));
    fixtures::shake_inner_nodes(box, 0.1, 3);
    const SolidMesh linear = solid_mesh_of(box);
    const SolidMesh triangles =
        fixtures::rectangle_mesh(ElementType::tri3, Formulation::plane_stress, {3, 2}, {3.0, 2.0});
    SolidMesh strained = with_edge_nodes(triangles);
    strained.formulation = Formulation::plane_strain;
    return {linear, with_edge_nodes(linear), triangles, strained,
            fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric, {3, 2},
                                     {3.0, 2.0})};
}

SolidModel model_of(const SolidMesh& mesh, const SolidMaterial& material) {
    SolidModel model{mesh, {material}, {}};
    model.prescribed.assign(3 * mesh.nodes.size(), 0);
    hold_in_plane(model);
    return model;
}

/// Every element, formulation, law and treatment of the volume.
std::vector<SolidModel> models() {
    std::vector<SolidModel> list;
    for (const SolidMesh& mesh : meshes())
        for (const SolidMaterial& material : materials()) {
            list.push_back(model_of(mesh, material));
            if (mesh.formulation == Formulation::plane_stress) continue;
            list.push_back(list.back());
            list.back().volume = VolumeTreatment::element_mean;
        }
    return list;
}

/// A smooth displacement with strains of about ten percent, in the plane for plane meshes.
Eigen::VectorXd bent(const SolidModel& model) {
    Eigen::VectorXd u(model.num_dofs());
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        u.segment<3>(3 * n) << 0.08 * x.x() + 0.03 * x.y() * x.y() + 0.01 * x.z() * x.x(),
            -0.05 * x.y() + 0.04 * std::sin(x.x()) + 0.03 * x.z(),
            0.06 * x.z() + 0.02 * x.x() * x.y();
        if (model.mesh.formulation != Formulation::solid) u[3 * n + 2] = 0;
    }
    return u;
}

std::string name_of_case(const SolidModel& model) {
    return std::string(model.volume == VolumeTreatment::element_mean ? "mean volume, " : "") +
           model.mesh.table().name + " " + name_of(model.mesh.formulation) + " " +
           model.materials[0].law;
}

TEST(SolidAssembly, ForcesAreTheSlopeOfTheEnergyAndTheTangentThatOfTheForces) {
    constexpr double step = 1e-6;
    for (const SolidModel& model : models()) {
        const SolidAssembly solid(model);
        const Eigen::VectorXd u = bent(model);
        Eigen::VectorXd way = Eigen::VectorXd::Zero(u.size());
        for (Index d = 0; d < model.num_dofs(); ++d)
            if (!model.prescribed[d]) way[d] = std::sin(1.7 * d);
        const InternalForce up = solid.internal_force(u + step * way);
        const InternalForce down = solid.internal_force(u - step * way);
        const InternalForce here = solid.internal_force(u);
        ASSERT_TRUE(here.is_valid) << name_of_case(model);
        EXPECT_NEAR((up.energy - down.energy) / (2 * step), here.force.dot(way),
                    1e-7 * here.force.norm() * way.norm())
            << name_of_case(model);

        BlockMatrix matrix = solid.make_matrix();
        solid.tangent(u, matrix);
        Eigen::VectorXd applied = Eigen::VectorXd::Zero(u.size());
        for (Index n = 0; n < matrix.num_rows(); ++n)
            for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
                applied.segment<3>(3 * n) +=
                    Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
                        matrix.block(k)) *
                    way.segment<3>(3 * matrix.graph.items[k]);
        const Eigen::VectorXd expected = (up.force - down.force) / (2 * step);
        double worst = 0;
        for (Index d = 0; d < model.num_dofs(); ++d)
            if (!model.prescribed[d]) worst = std::max(worst, std::abs(applied[d] - expected[d]));
        EXPECT_LT(worst, 1e-6 * expected.norm()) << name_of_case(model);
    }
}

TEST(SolidAssembly, InvertedMatterIsNotValid) {
    const SolidModel model = model_of(meshes()[0], materials()[1]);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(model.num_dofs());
    u[2] = 5;  // a corner through the box
    const InternalForce found = SolidAssembly(model).internal_force(u);
    EXPECT_FALSE(found.is_valid);
    EXPECT_TRUE(std::isinf(found.energy));
}

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
    for (SolidModel model : models()) {
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
        ASSERT_TRUE(found.converged) << name_of_case(model) << ": " << found.message;
        EXPECT_LT((found.displacement - loads.displacement).cwiseAbs().maxCoeff(), 1e-9)
            << name_of_case(model);
    }
}

/// Held at x = 0 and pulled at the other end, pushed by forces inside.
struct LoadedCase {
    SolidModel model;
    SolidLoads loads;
};

LoadedCase loaded(const SolidModel& model) {
    const SolidMesh& mesh = model.mesh;
    LoadedCase work{model, {}};
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setZero(work.model.num_dofs());
    const double end = mesh.formulation == Formulation::solid ? 2 : 3;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const double x = mesh.nodes[n].x();
        if (x < 1e-9 || x > end - 1e-9) std::fill_n(&work.model.prescribed[3 * n], 3, 1);
        if (x > end - 1e-9) work.loads.displacement[3 * n] = 0.1 * end;
        work.loads.force[3 * n + 1] = 0.05;
    }
    return work;
}

Eigen::VectorXd weights(Index dofs) {
    Eigen::VectorXd w(dofs);
    for (Index d = 0; d < dofs; ++d) w[d] = std::cos(0.9 * d);
    return w;
}

/// J = w . u
double value_of(const LoadedCase& work) {
    EquilibriumOptions options;
    options.relative_tolerance = 1e-12;
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, options);
    EXPECT_TRUE(found.converged) << found.message;
    return weights(work.model.num_dofs()).dot(found.displacement);
}

TEST(SolidAdjoint, GradientsAreThoseOfCentralDifferences) {
    for (const SolidModel& model : models()) {
        const SolidMaterial& material = model.materials[0];
        const LoadedCase work = loaded(model);
        const SolidAssembly solid(work.model);
        EquilibriumOptions options;
        options.relative_tolerance = 1e-12;
        const Equilibrium found = solve_equilibrium(solid, work.loads, options);
        ASSERT_TRUE(found.converged) << name_of_case(work.model) << ": " << found.message;
        const SolidGradient gradient = solid_gradient(solid, found, weights(work.model.num_dofs()));

        for (std::size_t k = 0; k < material.parameters.size(); ++k) {
            const double step = 1e-4 * material.parameters[k];
            LoadedCase up = work, down = work;
            up.model.materials[0].parameters[k] += step;
            down.model.materials[0].parameters[k] -= step;
            const double expected = (value_of(up) - value_of(down)) / (2 * step);
            EXPECT_NEAR(gradient.parameters[0][k], expected, 1e-5 * std::abs(expected) + 1e-9)
                << name_of_case(work.model) << " parameter " << k;
        }
        // Prescribed displacements and forces.
        for (Index d = 0; d < work.model.num_dofs(); ++d) {
            const bool is_wall = work.loads.displacement[d] != 0;
            const bool is_free = !work.model.prescribed[d];
            if (!is_wall && !(is_free && d % 7 == 1)) continue;
            constexpr double step = 1e-4;
            LoadedCase up = work, down = work;
            (is_wall ? up.loads.displacement : up.loads.force)[d] += step;
            (is_wall ? down.loads.displacement : down.loads.force)[d] -= step;
            const double expected = (value_of(up) - value_of(down)) / (2 * step);
            EXPECT_NEAR((is_wall ? gradient.displacement : gradient.force)[d], expected,
                        1e-5 * std::abs(expected) + 1e-7)
                << name_of_case(work.model) << " dof " << d;
        }
    }
}

/// The box between two plates, the upper one moved.
LoadedCase between_plates(const SolidMaterial& material, const Vec3& shift, bool both = false) {
    LoadedCase work{model_of(meshes()[0], material), {}};
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setZero(work.model.num_dofs());
    for (Index n = 0; n < work.model.mesh.num_nodes(); ++n) {
        const double z = work.model.mesh.nodes[n].z();
        if (z > 1e-9 && z < 2 - 1e-9) continue;
        std::fill_n(&work.model.prescribed[3 * n], 3, 1);
        if (z > 1 || both) work.loads.displacement.segment<3>(3 * n) = shift;
    }
    return work;
}

/// Norm of the forces that nothing balances, over that of all.
double imbalance(const LoadedCase& work, const Equilibrium& found) {
    Eigen::VectorXd force = SolidAssembly(work.model).internal_force(found.displacement).force;
    const double scale = force.norm();
    force -= found.load * work.loads.force;
    for (Index d = 0; d < work.model.num_dofs(); ++d)
        if (work.model.prescribed[d]) force[d] = 0;
    return force.norm() / scale;
}

TEST(SolidAdjoint, AnObjectiveOfTheWrongSizeIsRefused) {
    const LoadedCase work = loaded(models()[2]);
    const SolidAssembly solid(work.model);
    const Equilibrium found = solve_equilibrium(solid, work.loads, {});
    EXPECT_THROW(solid_gradient(solid, found, Eigen::VectorXd::Zero(3)), Error);
}

TEST(Equilibrium, AHeavyLoadIsReached) {
    for (std::size_t k = 1; k < materials().size(); ++k) {
        const LoadedCase work = between_plates(materials()[k], Vec3(0, 0, -1.5));  // 75 %
        const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
        ASSERT_TRUE(found.converged) << materials()[k].law << ": " << found.message;
        EXPECT_LT(imbalance(work, found), 1e-8) << materials()[k].law;
        EXPECT_LT(found.records.back().relative_residual, 1e-9);
    }
}

TEST(Equilibrium, LoadStepsGrowAndEndWhereOneStepEnds) {
    const LoadedCase work = between_plates(materials()[1], Vec3(0, 0, -0.5));
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
    for (const SolidMaterial& material : materials()) {
        const LoadedCase work = between_plates(material, Vec3(0.13, 0.07, -0.3), true);
        const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
        EXPECT_TRUE(found.converged) << material.law << ": " << found.message;
        EXPECT_LT(found.reaction.norm(), 1e-10);
    }
}

// Dead loads of a third of the shear modulus and more, from where Newton alone loses its way.
TEST(Equilibrium, ALargePressureIsReachedThroughTangentsThatAreNotDefinite) {
    for (const std::string& library : sparse_factor_names())
        for (const double pressure : {5.0, 30.0}) {
            LoadedCase work = between_plates(materials()[1], Vec3::Zero());
            for (Index n = 0; n < work.model.mesh.num_nodes(); ++n)
                if (work.model.mesh.nodes[n].z() > 1)
                    std::fill_n(&work.model.prescribed[3 * n], 3, 0);
            const auto top = boundary_faces(
                work.model.mesh, [&](Index n) { return work.model.mesh.nodes[n].z() > 2 - 1e-9; });
            work.loads.force = traction_forces(
                work.model.mesh, top, [&](const Vec3&, const Vec3& n) { return -pressure * n; });
            EquilibriumOptions options;
            options.direct_library = library;
            const Equilibrium found =
                solve_equilibrium(SolidAssembly(work.model), work.loads, options);
            ASSERT_TRUE(found.converged)
                << pressure << " kPa, " << library << ": " << found.message;
            EXPECT_LT(imbalance(work, found), 1e-8);
        }
}

TEST(Equilibrium, ReactionsBalanceForcesThatReachOntoTheClamp) {
    LoadedCase work = loaded(model_of(meshes()[0], materials()[1]));
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
    const LoadedCase work = between_plates(materials()[1], Vec3(0, 0, -2.5));  // through the floor
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
    LoadedCase work{model_of(meshes()[0], materials()[1]), {}};
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setOnes(work.model.num_dofs());
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
    EXPECT_FALSE(found.converged);
}

TEST(Equilibrium, OptionsOutOfRangeAreRefused) {
    const LoadedCase work = between_plates(materials()[1], Vec3(0, 0, -0.1));
    EquilibriumOptions options;
    options.smallest_step = 0;
    EXPECT_THROW(solve_equilibrium(SolidAssembly(work.model), work.loads, options), Error);
    options = {};
    options.max_newton_steps = 0;
    EXPECT_THROW(solve_equilibrium(SolidAssembly(work.model), work.loads, options), Error);
}

TEST(SolidAssembly, PlaneStressOfLargeStretchesIsSolved) {
    for (const double ratio : {0.45, 0.49, 0.4999}) {
        const SolidModel model = model_of(
            fixtures::rectangle_mesh(ElementType::tri3, Formulation::plane_stress, {1, 1}, {1, 1}),
            {"neo-hookean", {10, ratio}});
        for (const double stretch : {0.6, 1.7, 2.0}) {
            Eigen::VectorXd u = Eigen::VectorXd::Zero(model.num_dofs());
            for (Index n = 0; n < model.mesh.num_nodes(); ++n)
                u.segment<3>(3 * n) = (stretch - 1) * model.mesh.nodes[n];
            EXPECT_TRUE(SolidAssembly(model).internal_force(u).is_valid) << ratio << " " << stretch;
        }
    }
}

TEST(Equilibrium, LoadsOfTheWrongSizeOrThatAreNoNumbersAreRefused) {
    const SolidModel model = model_of(meshes()[0], materials()[1]);
    const SolidAssembly solid(model);
    SolidLoads loads{Eigen::VectorXd::Zero(3), Eigen::VectorXd::Zero(model.num_dofs())};
    EXPECT_THROW(solve_equilibrium(solid, loads, {}), Error);
    loads.displacement.setConstant(model.num_dofs(), std::nan(""));
    EXPECT_THROW(solve_equilibrium(solid, loads, {}), Error);
}

}  // namespace
}  // namespace palpate

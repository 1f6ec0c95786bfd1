// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/solid_adjoint.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/adjoint/sensitivity_columns.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/time_steps.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using namespace fixtures;

Eigen::VectorXd weights(Index dofs) {
    Eigen::VectorXd w(dofs);
    for (Index d = 0; d < dofs; ++d) w[d] = std::cos(0.9 * d);
    return w;
}

/// J = w . u
double value_of(const LoadedModel& work) {
    EquilibriumOptions options;
    options.relative_tolerance = 1e-12;
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, options);
    EXPECT_TRUE(found.converged) << found.message;
    return weights(work.model.num_dofs()).dot(found.displacement);
}

TEST(SolidAdjoint, GradientsAreThoseOfCentralDifferences) {
    for (const SolidModel& model : solid_models()) {
        const SolidMaterial& material = model.materials[0];
        const LoadedModel work = pulled(model);
        const SolidAssembly solid(work.model);
        EquilibriumOptions options;
        options.relative_tolerance = 1e-12;
        const Equilibrium found = solve_equilibrium(solid, work.loads, options);
        ASSERT_TRUE(found.converged) << name_of(work.model) << ": " << found.message;
        const SolidGradient gradient = solid_gradient(solid, found, weights(work.model.num_dofs()));

        for (std::size_t k = 0; k < material.parameters.size(); ++k) {
            const double step = 1e-4 * material.parameters[k];
            LoadedModel up = work, down = work;
            up.model.materials[0].parameters[k] += step;
            down.model.materials[0].parameters[k] -= step;
            const double expected = (value_of(up) - value_of(down)) / (2 * step);
            EXPECT_NEAR(gradient.parameters[0][k], expected, 1e-5 * std::abs(expected) + 1e-9)
                << name_of(work.model) << " parameter " << k;
        }
        // Prescribed displacements and forces.
        for (Index d = 0; d < work.model.num_dofs(); ++d) {
            const bool is_wall = work.loads.displacement[d] != 0;
            const bool is_free = !work.model.prescribed[d];
            if (!is_wall && !(is_free && d % 7 == 1)) continue;
            constexpr double step = 1e-4;
            LoadedModel up = work, down = work;
            (is_wall ? up.loads.displacement : up.loads.force)[d] += step;
            (is_wall ? down.loads.displacement : down.loads.force)[d] -= step;
            const double expected = (value_of(up) - value_of(down)) / (2 * step);
            EXPECT_NEAR((is_wall ? gradient.displacement : gradient.force)[d], expected,
                        1e-5 * std::abs(expected) + 1e-7)
                << name_of(work.model) << " dof " << d;
        }
    }
}

/// A plate that drags, so that K is not symmetric.
LoadedModel dragged(const SolidModel& model) {
    LoadedModel work = pulled(model);
    const SolidMesh& mesh = work.model.mesh;
    const int up = mesh.formulation == Formulation::solid ? 2 : 1;
    Contact contact;
    contact.obstacle.place[up] = 2;
    contact.obstacle.direction = -Vec3::Unit(up);
    contact.stiffness_kpa_per_mm = contact.slip_stiffness_kpa_per_mm = 40;
    contact.friction = 0.3;
    contact.faces = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n][up] > 2 - 1e-9; });
    work.model.contacts = {contact};
    work.loads.obstacle_motion = {-0.2 * Vec3::Unit(up)};
    return work;
}

TEST(SensitivityColumns, AgreeWithTheGradientOfEveryObjective) {
    for (const SolidModel& bare : solid_models()) {
        const LoadedModel work = dragged(bare);
        const SolidAssembly solid(work.model);
        EquilibriumOptions options;
        options.relative_tolerance = 1e-12;
        const Equilibrium found = solve_equilibrium(solid, work.loads, options);
        ASSERT_TRUE(found.converged) << name_of(bare) << ": " << found.message;
        std::vector<Index> walls;
        for (Index d = 0; d < work.model.num_dofs(); ++d)
            if (work.loads.displacement[d] != 0) walls.push_back(d);
        const auto by_parameter = parameter_columns(solid, found);
        const Eigen::MatrixXd by_wall = displacement_columns(solid, found, walls);
        Eigen::MatrixXd slopes(work.model.num_dofs(), 5);
        for (int c = 0; c < 5; ++c)
            slopes.col(c) = weights(work.model.num_dofs() + c).tail(slopes.rows());
        const Eigen::MatrixXd by_force = adjoint_columns(solid, found, slopes);
        for (int c = 0; c < 5; ++c) {
            const Eigen::VectorXd slope = slopes.col(c);
            const SolidGradient gradient = solid_gradient(solid, found, slope);
            EXPECT_LT((by_force.col(c) - gradient.force).norm(), 1e-9 * gradient.force.norm());
            for (std::size_t k = 0; k < gradient.parameters[0].size(); ++k)
                EXPECT_NEAR(by_parameter[0].col(k).dot(slope), gradient.parameters[0][k],
                            1e-7 * std::abs(gradient.parameters[0][k]) + 1e-10)
                    << name_of(bare);
            for (std::size_t k = 0; k < walls.size(); ++k)
                EXPECT_NEAR(by_wall.col(k).dot(slope), gradient.displacement[walls[k]], 1e-7)
                    << name_of(bare);
        }
    }
}

TEST(SensitivityColumns, AFreeDofIsNotPrescribed) {
    const LoadedModel work = pulled(solid_models()[2]);
    const SolidAssembly solid(work.model);
    const Equilibrium found = solve_equilibrium(solid, work.loads, {});
    Index free = 0;
    while (work.model.prescribed[free]) ++free;
    EXPECT_THROW(displacement_columns(solid, found, std::vector<Index>{free}), Error);
    EXPECT_THROW(adjoint_columns(solid, found, Eigen::MatrixXd::Zero(3, 2)), Error);
}

TEST(SolidAdjoint, AnObjectiveOfTheWrongSizeIsRefused) {
    const LoadedModel work = pulled(solid_models()[2]);
    const SolidAssembly solid(work.model);
    const Equilibrium found = solve_equilibrium(solid, work.loads, {});
    EXPECT_THROW(solid_gradient(solid, found, Eigen::VectorXd::Zero(3)), Error);
}

TEST(SolidAdjoint, AStateOfALoadHistoryHasNoGradientOfItsOwn) {
    const LoadedModel work = pulled(solid_models()[2]);
    const auto states = solve_history(work.model, {{1, work.loads}}, {});
    EXPECT_THROW(solid_gradient(SolidAssembly(work.model), states[0],
                                Eigen::VectorXd::Ones(work.model.num_dofs())),
                 Error);
}

}  // namespace
}  // namespace palpate

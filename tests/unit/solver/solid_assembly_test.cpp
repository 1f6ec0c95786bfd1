// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/solid_assembly.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/equilibrium/tangent_solve.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using namespace fixtures;

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

TEST(SolidAssembly, ForcesAreTheSlopeOfTheEnergyAndTheTangentThatOfTheForces) {
    constexpr double step = 1e-6;
    for (const SolidModel& model : solid_models()) {
        const SolidAssembly solid(model);
        const Eigen::VectorXd u = bent(model);
        Eigen::VectorXd way = Eigen::VectorXd::Zero(u.size());
        for (Index d = 0; d < model.num_dofs(); ++d)
            if (!model.prescribed[d]) way[d] = std::sin(1.7 * d);
        const InternalForce up = solid.internal_force(u + step * way);
        const InternalForce down = solid.internal_force(u - step * way);
        const InternalForce here = solid.internal_force(u);
        ASSERT_TRUE(here.is_valid) << name_of(model);
        EXPECT_NEAR((up.energy - down.energy) / (2 * step), here.force.dot(way),
                    1e-7 * here.force.norm() * way.norm())
            << name_of(model);

        TangentSolve tangent(solid, {});
        tangent.factorise(u);
        const Eigen::VectorXd applied = tangent.times(way);
        const Eigen::VectorXd expected = (up.force - down.force) / (2 * step);
        double worst = 0;
        for (Index d = 0; d < model.num_dofs(); ++d)
            if (!model.prescribed[d]) worst = std::max(worst, std::abs(applied[d] - expected[d]));
        EXPECT_LT(worst, 1e-6 * expected.norm()) << name_of(model);
    }
}

TEST(SolidAssembly, InvertedMatterIsNotValid) {
    const SolidModel model = solid_model(solid_meshes()[0], solid_materials()[1]);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(model.num_dofs());
    u[2] = 5;  // a corner through the box
    const InternalForce found = SolidAssembly(model).internal_force(u);
    EXPECT_FALSE(found.is_valid);
    EXPECT_TRUE(std::isinf(found.energy));
}

TEST(SolidAssembly, PlaneStressOfLargeStretchesIsSolved) {
    for (const double ratio : {0.45, 0.49, 0.4999}) {
        const SolidModel model = solid_model(
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

}  // namespace
}  // namespace palpate

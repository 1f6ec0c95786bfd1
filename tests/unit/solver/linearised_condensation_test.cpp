// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "solver/base/error.hpp"
#include "solver/condense/condensation.hpp"
#include "solver/equilibrium/newton.hpp"
#include "solver/model/tet4_model.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/linear_solvers.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

constexpr char law[] = "neo-hookean";

/// A box of two tissues, its upper side pushed down and sideways by a tenth of its height.
struct Scene {
    Model model = fixtures::two_tissue_model({4, 5, 4});
    std::vector<Index> observed = fixtures::interface_nodes(model.mesh);
    std::vector<Index> driven =
        fixtures::select_nodes(model.mesh, [](const Vec3& p) { return p.z() > 39.9; });
    Eigen::VectorXd walls = push();

    Scene() { fixtures::prescribe(model, driven); }

    Eigen::VectorXd push() const {
        Eigen::VectorXd u(3 * driven.size());
        for (std::size_t k = 0; k < driven.size(); ++k) {
            const Vec3& x = model.mesh.nodes[driven[k]];
            u.segment<3>(3 * k) = Vec3(3, 1 - 0.05 * x.y(), -6 + 0.08 * x.x());
        }
        return u;
    }
    Equilibrium equilibrium(const Eigen::VectorXd& moved) const {
        SolidLoads loads{Eigen::VectorXd::Zero(model.num_dofs()),
                         Eigen::VectorXd::Zero(model.num_dofs())};
        for (std::size_t k = 0; k < driven.size(); ++k)
            loads.displacement.segment<3>(3 * driven[k]) = moved.segment<3>(3 * k);
        EquilibriumOptions tight;
        tight.relative_tolerance = 1e-12;
        Equilibrium found =
            solve_equilibrium(SolidAssembly(solid_model_of(model, law)), loads, tight);
        found.tangent.reset();
        EXPECT_TRUE(found.converged) << found.message;
        return found;
    }
    Eigen::VectorXd seen(const Eigen::VectorXd& u) const {
        Eigen::VectorXd part(3 * observed.size());
        for (std::size_t k = 0; k < observed.size(); ++k)
            part.segment<3>(3 * k) = u.segment<3>(3 * observed[k]);
        return part;
    }
    std::vector<CondensedRegion> condensed_at(const Eigen::VectorXd& u) const {
        return condense_at(u, solid_model_of(model, law), observed, driven,
                           fixtures::solver_on("reference"));
    }
};

/// Sums over the regions at the moduli of `model`.
struct Sums {
    Eigen::MatrixXd stiffness, coupling;
    Eigen::VectorXd force;

    Sums(const Scene& scene, const std::vector<CondensedRegion>& regions)
        : stiffness(Eigen::MatrixXd::Zero(3 * scene.observed.size(), 3 * scene.observed.size())),
          coupling(Eigen::MatrixXd::Zero(3 * scene.observed.size(), 3 * scene.driven.size())),
          force(Eigen::VectorXd::Zero(3 * scene.observed.size())) {
        for (const CondensedRegion& r : regions) {
            const double kpa = scene.model.materials[r.region].stiffness_kpa;
            for (std::size_t i = 0; i < r.observed.size(); ++i) {
                if (r.observed_force.size() > 0)
                    force.segment<3>(3 * r.observed[i]) += kpa * r.observed_force.segment<3>(3 * i);
                for (std::size_t j = 0; j < r.observed.size(); ++j)
                    stiffness.block<3, 3>(3 * r.observed[i], 3 * r.observed[j]) +=
                        kpa * r.observed_observed.block<3, 3>(3 * i, 3 * j);
                for (std::size_t j = 0; j < r.driven.size(); ++j)
                    coupling.block<3, 3>(3 * r.observed[i], 3 * r.driven[j]) +=
                        kpa * r.observed_driven.block<3, 3>(3 * i, 3 * j);
            }
        }
    }
};

TEST(CondenseAt, IsLinearElasticityAtRest) {
    const Scene scene;

    const auto rest = scene.condensed_at(Eigen::VectorXd::Zero(scene.model.num_dofs()));

    const auto linear = condense(solid_model_of(scene.model), scene.observed, scene.driven,
                                 fixtures::solver_on("reference"));
    ASSERT_EQ(rest.size(), linear.size());
    for (std::size_t r = 0; r < rest.size(); ++r) {
        const auto& expected = linear[r].observed_observed;
        EXPECT_LT((rest[r].observed_observed - expected).norm(), 1e-9 * expected.norm());
        EXPECT_LT((rest[r].observed_driven - linear[r].observed_driven).norm(),
                  1e-9 * expected.norm());
        EXPECT_EQ(rest[r].observed_force.norm(), 0);
    }
}

TEST(CondenseAt, SumsToTheTangentOfTheWholeBody) {
    const Scene scene;
    const Equilibrium state = scene.equilibrium(scene.walls);
    const SolidAssembly assembly(solid_model_of(scene.model, law));
    TangentSolve tangent(assembly, {});
    ASSERT_TRUE(tangent.factorise(state.displacement));
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(scene.model.num_dofs());
    Eigen::VectorXd step = Eigen::VectorXd::LinSpaced(3 * scene.driven.size(), -1, 1);
    for (std::size_t k = 0; k < scene.driven.size(); ++k)
        moved.segment<3>(3 * scene.driven[k]) = step.segment<3>(3 * k);
    tangent.solve(Eigen::VectorXd::Zero(moved.size()), moved);

    const Sums sums(scene, scene.condensed_at(state.displacement));

    const Eigen::VectorXd expected = scene.seen(moved);
    const Eigen::VectorXd answer = -sums.stiffness.partialPivLu().solve(sums.coupling * step);
    EXPECT_LT((answer - expected).norm(), 1e-9 * expected.norm());
}

/// Moves walls and moduli by `part` of a step; returns how far the linearised answer is off.
double error_of_linearised(const Scene& at, const Equilibrium& state,
                           const std::vector<CondensedRegion>& regions, double part,
                           double* change) {
    Scene moved = at;
    const Eigen::VectorXd step = part * Eigen::VectorXd::LinSpaced(3 * at.driven.size(), -2, 3);
    moved.walls += step;
    moved.model.materials[1].stiffness_kpa *= std::exp(part);
    const Sums sums(moved, regions);
    const Eigen::VectorXd linearised =
        -sums.stiffness.partialPivLu().solve(sums.coupling * step + sums.force);
    const Eigen::VectorXd exact =
        moved.seen(moved.equilibrium(moved.walls).displacement) - at.seen(state.displacement);
    *change = exact.norm();
    return (linearised - exact).norm();
}

TEST(CondenseAt, AnswersNewWallsAndModuliToFirstOrder) {
    const Scene scene;
    const Equilibrium state = scene.equilibrium(scene.walls);
    const auto regions = scene.condensed_at(state.displacement);

    double change = 0, smaller_change = 0;
    const double error = error_of_linearised(scene, state, regions, 0.1, &change);
    const double smaller = error_of_linearised(scene, state, regions, 0.05, &smaller_change);

    EXPECT_LT(smaller, 0.02 * smaller_change);
    EXPECT_NEAR(error / smaller, 4, 0.4);  // what is left is of second order
}

TEST(CondenseAt, LeavesNothingUnbalancedAtTheModuliOfTheEquilibrium) {
    const Scene scene;
    const Equilibrium state = scene.equilibrium(scene.walls);
    const auto regions = scene.condensed_at(state.displacement);
    const auto forces = region_forces(state.displacement, solid_model_of(scene.model, law),
                                      scene.observed, scene.driven);

    const Sums sums(scene, regions);

    double size = 0;
    ASSERT_EQ(forces.size(), regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        size += regions[r].observed_force.norm();
        EXPECT_EQ((forces[r].observed_force - regions[r].observed_force).norm(), 0);
    }
    EXPECT_LT(sums.force.norm(), 1e-8 * size);
}

TEST(CondenseAt, RefusesAStateOfAnotherMesh) {
    const Scene scene;
    EXPECT_EQ(fixtures::code_of([&] { scene.condensed_at(Eigen::VectorXd::Zero(3)); }),
              ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace palpate

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
    std::vector<CondensedMotions> condensed_at(const Eigen::VectorXd& u, const Eigen::MatrixXd& v,
                                               const Eigen::MatrixXd& d) const {
        return condense_at(u, solid_model_of(model, law), observed, driven, v, d,
                           fixtures::solver_on("reference"));
    }
    /// For every motion of the observed and driven nodes.
    std::vector<CondensedMotions> condensed_at(const Eigen::VectorXd& u) const {
        return condensed_at(u, identity(observed), identity(driven));
    }
    std::vector<RegionForce> forces_at(const Eigen::VectorXd& u) const {
        return region_forces(u, solid_model_of(model, law), observed, driven);
    }
    static Eigen::MatrixXd identity(const std::vector<Index>& nodes) {
        const auto n = static_cast<Eigen::Index>(3 * nodes.size());
        return Eigen::MatrixXd::Identity(n, n);
    }
};

/// Sums over the regions at the moduli of `model`.
struct Sums {
    Eigen::MatrixXd stiffness, coupling;
    Eigen::VectorXd force;

    Sums(const Scene& scene, const std::vector<CondensedMotions>& regions,
         const std::vector<RegionForce>& forces)
        : stiffness(Eigen::MatrixXd::Zero(3 * scene.observed.size(), 3 * scene.observed.size())),
          coupling(Eigen::MatrixXd::Zero(3 * scene.observed.size(), 3 * scene.driven.size())),
          force(Eigen::VectorXd::Zero(3 * scene.observed.size())) {
        for (std::size_t r = 0; r < regions.size(); ++r) {
            const double kpa = scene.model.materials[regions[r].region].stiffness_kpa;
            stiffness += kpa * regions[r].stiffness;
            coupling += kpa * regions[r].coupling;
            force += kpa * forces[r].force;
        }
    }
};

/// Rows of all observed or driven nodes for those of one region.
Eigen::MatrixXd spread_to(const Eigen::MatrixXd& block, const std::vector<Index>& rows,
                          Eigen::Index num_rows, const std::vector<Index>& columns,
                          Eigen::Index num_columns) {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(num_rows, num_columns);
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = 0; j < columns.size(); ++j)
            whole.block<3, 3>(3 * rows[i], 3 * columns[j]) = block.block<3, 3>(3 * i, 3 * j);
    return whole;
}

TEST(CondenseAt, IsLinearElasticityAtRest) {
    const Scene scene;

    const auto rest = scene.condensed_at(Eigen::VectorXd::Zero(scene.model.num_dofs()));

    const auto linear = condense(solid_model_of(scene.model), scene.observed, scene.driven,
                                 fixtures::solver_on("reference"));
    ASSERT_EQ(rest.size(), linear.size());
    for (std::size_t r = 0; r < rest.size(); ++r) {
        const CondensedRegion& own = linear[r];
        const Eigen::MatrixXd stiffness =
            spread_to(own.observed_observed, own.observed, rest[r].stiffness.rows(), own.observed,
                      rest[r].stiffness.cols());
        const Eigen::MatrixXd coupling =
            spread_to(own.observed_driven, own.observed, rest[r].coupling.rows(), own.driven,
                      rest[r].coupling.cols());
        EXPECT_EQ(rest[r].region, own.region);
        EXPECT_LT((rest[r].stiffness - stiffness).norm(), 1e-9 * stiffness.norm());
        EXPECT_LT((rest[r].coupling - coupling).norm(), 1e-9 * stiffness.norm());
    }
    for (const RegionForce& own : scene.forces_at(Eigen::VectorXd::Zero(scene.model.num_dofs())))
        EXPECT_EQ(own.force.norm(), 0);
}

TEST(CondenseAt, ProjectsOntoTheMotionsThatAreAskedFor) {
    const Scene scene;
    const Eigen::VectorXd u = scene.equilibrium(scene.walls).displacement;
    const auto all = scene.condensed_at(u);
    const Eigen::MatrixXd v = Eigen::MatrixXd::Random(3 * scene.observed.size(), 150);
    const Eigen::MatrixXd d = Eigen::MatrixXd::Random(3 * scene.driven.size(), 7);

    const auto some = scene.condensed_at(u, v, d);

    ASSERT_EQ(some.size(), all.size());
    for (std::size_t r = 0; r < all.size(); ++r) {
        const Eigen::MatrixXd stiffness = v.transpose() * all[r].stiffness * v;
        const Eigen::MatrixXd coupling = v.transpose() * all[r].coupling * d;
        EXPECT_LT((some[r].stiffness - stiffness).norm(), 1e-9 * stiffness.norm());
        EXPECT_LE((some[r].coupling - coupling).norm(), 1e-9 * coupling.norm());
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

    const Sums sums(scene, scene.condensed_at(state.displacement),
                    scene.forces_at(state.displacement));

    const Eigen::VectorXd expected = scene.seen(moved);
    const Eigen::VectorXd answer = -sums.stiffness.partialPivLu().solve(sums.coupling * step);
    EXPECT_LT((answer - expected).norm(), 1e-9 * expected.norm());
}

/// Moves walls and moduli by `part` of a step; returns how far the linearised answer is off.
double error_of_linearised(const Scene& at, const Equilibrium& state,
                           const std::vector<CondensedMotions>& regions, double part,
                           double* change) {
    Scene moved = at;
    const Eigen::VectorXd step = part * Eigen::VectorXd::LinSpaced(3 * at.driven.size(), -2, 3);
    moved.walls += step;
    moved.model.materials[1].stiffness_kpa *= std::exp(part);
    const Sums sums(moved, regions, at.forces_at(state.displacement));
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
    const auto forces = scene.forces_at(state.displacement);

    const Sums sums(scene, regions, forces);

    double size = 0;
    ASSERT_EQ(forces.size(), regions.size());
    for (const RegionForce& own : forces) size += own.force.norm();
    EXPECT_LT(sums.force.norm(), 1e-8 * size);
}

TEST(CondenseAt, RefusesAStateOfAnotherMesh) {
    const Scene scene;
    EXPECT_EQ(fixtures::code_of([&] { scene.condensed_at(Eigen::VectorXd::Zero(3)); }),
              ErrorCode::invalid_argument);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(scene.model.num_dofs());
    const Eigen::MatrixXd few = Eigen::MatrixXd::Zero(3, 2);
    EXPECT_EQ(
        fixtures::code_of([&] { scene.condensed_at(rest, few, Scene::identity(scene.driven)); }),
        ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace palpate

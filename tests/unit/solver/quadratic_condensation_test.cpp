// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <functional>
#include <random>

#include "solver/base/error.hpp"
#include "solver/condense/condensation.hpp"
#include "solver/equilibrium/rest_solver.hpp"
#include "solver/model/node_rows.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/tet4_model.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/linear_solvers.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

constexpr double direct_tolerance = 1e-9;  ///< rounding of two factorisations
constexpr double poisson_ratio = 0.35;

/// Nodes between two regions, and nodes on the sides of the box.
std::vector<Index> nodes_between(const SolidMesh& mesh) {
    std::vector<std::uint8_t> touches(mesh.nodes.size(), 0);
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (const Index n : mesh.nodes_of(e))
            touches[n] |= static_cast<std::uint8_t>(1 << mesh.region[e]);
    std::vector<Index> nodes;
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (touches[n] == 3) nodes.push_back(n);
    return nodes;
}

std::vector<Index> nodes_outside(const SolidMesh& mesh) {
    Vec3 low = mesh.nodes[0], high = mesh.nodes[0];
    for (const Vec3& p : mesh.nodes) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    std::vector<Index> nodes;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const Vec3& p = mesh.nodes[n];
        if (((p - low).array() < 1e-9).any() || ((high - p).array() < 1e-9).any())
            nodes.push_back(n);
    }
    return nodes;
}

/// A box of two tissues of tet10, all its sides driven, the nodes between the tissues observed.
struct Scene {
    SolidModel model = solid_model_of(fixtures::two_tissue_model({3, 4, 3}));
    std::vector<Index> observed, driven;

    Scene() {
        model.mesh = with_edge_nodes(model.mesh);
        driven = nodes_outside(model.mesh);
        std::ranges::set_difference(nodes_between(model.mesh), driven,
                                    std::back_inserter(observed));
        model.prescribed.assign(model.num_dofs(), 0);
        for (const Index n : driven)
            for (int c = 0; c < 3; ++c) model.prescribed[3 * n + c] = 1;
        for (SolidMaterial& material : model.materials) material.parameters[1] = poisson_ratio;
    }
    std::vector<CondensedRegion> condensed() const {
        return condense(model, observed, driven, fixtures::solver_on("reference"));
    }
};

/// u_o of (sum E_r S_r,oo) u_o = -(sum E_r S_r,od) u_d.
Eigen::VectorXd condensed_answer(const Scene& scene, const std::vector<CondensedRegion>& regions,
                                 const Eigen::VectorXd& driven) {
    const auto size = static_cast<Index>(3 * scene.observed.size());
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(size);
    for (const CondensedRegion& r : regions) {
        const double kpa = scene.model.materials[r.region].parameters[0];
        const Eigen::VectorXd push = kpa * r.observed_driven * at_nodes(driven, r.driven);
        for (std::size_t i = 0; i < r.observed.size(); ++i) {
            force.segment<3>(3 * r.observed[i]) -= push.segment<3>(3 * i);
            for (std::size_t j = 0; j < r.observed.size(); ++j)
                stiffness.block<3, 3>(3 * r.observed[i], 3 * r.observed[j]) +=
                    kpa * r.observed_observed.block<3, 3>(3 * i, 3 * j);
        }
    }
    return stiffness.partialPivLu().solve(force);
}

Eigen::VectorXd full_answer(const Scene& scene, const Eigen::VectorXd& driven) {
    Columns b = Columns::Zero(scene.model.num_dofs(), 1), x;
    for (std::size_t k = 0; k < scene.driven.size(); ++k)
        b.middleRows<3>(3 * scene.driven[k]) = driven.segment<3>(3 * k);
    make_rest_solver(scene.model, fixtures::solver_on("reference"))->solve(b, x);
    return at_nodes(x.col(0), scene.observed);
}

Eigen::VectorXd field_at(const SolidMesh& mesh, const std::vector<Index>& nodes,
                         const std::function<Vec3(const Vec3&)>& field) {
    Eigen::VectorXd values(3 * nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k)
        values.segment<3>(3 * k) = field(mesh.nodes[nodes[k]]);
    return values;
}

/// One tissue in both regions: a field that is in equilibrium has to come out.
void expect_exact(const std::function<Vec3(const Vec3&)>& field) {
    Scene scene;
    for (SolidMaterial& material : scene.model.materials) material.parameters[0] = 7;

    const Eigen::VectorXd answer =
        condensed_answer(scene, scene.condensed(), field_at(scene.model.mesh, scene.driven, field));

    const Eigen::VectorXd exact = field_at(scene.model.mesh, scene.observed, field);
    EXPECT_LT((answer - exact).norm(), direct_tolerance * exact.norm());
}

TEST(CondenseTet10, PassesThePatchTest) {
    expect_exact([](const Vec3& p) {
        return Vec3(0.1 * p.x() - 0.02 * p.y() + 0.5, 0.03 * p.z() - 0.04 * p.y(),
                    0.05 * p.x() + 0.01 * p.z());
    });
}

/// Pure bending of a beam along x (St Venant): quadratic in the place, without forces inside.
TEST(CondenseTet10, BendsExactly) {
    expect_exact([](const Vec3& p) {
        const double nu = poisson_ratio;
        return Vec3(0.01 * p.x() * p.z(), -0.01 * nu * p.y() * p.z(),
                    -0.005 * (p.x() * p.x() - nu * p.y() * p.y() + nu * p.z() * p.z()));
    });
}

TEST(CondenseTet10, GivesTheAnswerOfTheFullModelAtRandomModuli) {
    Scene scene;
    const auto regions = scene.condensed();
    ASSERT_EQ(regions.size(), 2u);
    const Eigen::VectorXd driven =
        Eigen::VectorXd::LinSpaced(static_cast<Index>(3 * scene.driven.size()), -1, 2);

    std::mt19937 random(5);
    std::uniform_real_distribution<double> log_stiffness(std::log(2.0), std::log(800.0));
    for (int trial = 0; trial < 3; ++trial) {
        for (SolidMaterial& material : scene.model.materials)
            material.parameters[0] = std::exp(log_stiffness(random));
        const Eigen::VectorXd full = full_answer(scene, driven);
        const Eigen::VectorXd condensed = condensed_answer(scene, regions, driven);
        EXPECT_LT((full - condensed).norm(), direct_tolerance * full.norm());
    }
}

TEST(RestSolver, TakesNewModuliAsIfItHadBegunWithThem) {
    Scene scene;
    const auto solver = make_rest_solver(scene.model, fixtures::solver_on("reference"));
    Columns b = Columns::Zero(scene.model.num_dofs(), 1), changed, fresh;
    for (const Index n : scene.observed) b(3 * n, 0) = 1;

    solver->set_stiffness(std::vector<double>{3.0, 50.0});
    solver->solve(b, changed);

    scene.model.materials[0].parameters[0] = 3;
    scene.model.materials[1].parameters[0] = 50;
    make_rest_solver(scene.model, fixtures::solver_on("reference"))->solve(b, fresh);
    EXPECT_GT(fresh.norm(), 0);
    EXPECT_LT((changed - fresh).norm(), 1e-12 * fresh.norm());
}

TEST(RestSolver, SaysThatTheHostFactorises) {
    const Scene scene;

    const LinearSolverInfo info =
        make_rest_solver(scene.model, fixtures::solver_on("reference"))->describe();

    EXPECT_EQ(info.method, LinearMethod::direct);
    EXPECT_NE(info.reason.find("tet10 elements: factorised on the host"), std::string::npos);
}

TEST(RestSolver, RefusesConjugateGradientsOfQuadraticElements) {
    const Scene scene;
    LinearSolverOptions options = fixtures::solver_on("reference");
    options.method = LinearMethod::multigrid;

    EXPECT_EQ(fixtures::code_of([&] { make_rest_solver(scene.model, options); }),
              ErrorCode::unsupported);
}

TEST(StiffnessAtRest, IsTheSameFromBothWaysForTet4) {
    const Model linear = fixtures::two_tissue_model({3, 4, 3});
    SolidModel general = solid_model_of(linear);
    const StiffnessMatrix fast = stiffness_at_rest(general);
    general.volume = VolumeTreatment::element_mean;  // the same for one point, but another way

    ASSERT_FALSE(is_linear_tet4(general));
    const StiffnessMatrix slow = stiffness_at_rest(general);

    ASSERT_EQ(fast.blocks.size(), slow.blocks.size());
    for (std::size_t k = 0; k < fast.blocks.size(); ++k)
        ASSERT_NEAR(fast.blocks[k], slow.blocks[k], 1e-9);
}

TEST(Tet4Model, IsWhatItWasMadeFrom) {
    const Model model = fixtures::two_tissue_model({3, 4, 3});

    const Model same = tet4_model_of(solid_model_of(model));

    EXPECT_EQ(same.mesh.nodes, model.mesh.nodes);
    EXPECT_EQ(same.mesh.tets, model.mesh.tets);
    EXPECT_EQ(same.mesh.region, model.mesh.region);
    EXPECT_EQ(same.prescribed, model.prescribed);
    ASSERT_EQ(same.materials.size(), model.materials.size());
    EXPECT_EQ(same.materials[1].stiffness_kpa, model.materials[1].stiffness_kpa);
    EXPECT_EQ(same.materials[1].poisson_ratio, model.materials[1].poisson_ratio);
    EXPECT_EQ(fixtures::code_of([&] { tet4_model_of(solid_model_of(model, "neo-hookean")); }),
              ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace palpate

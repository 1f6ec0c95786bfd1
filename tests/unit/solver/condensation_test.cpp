// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/condense/condensation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "solver/base/error.hpp"
#include "solver/linear/make_linear_solver.hpp"
#include "solver/model/tet4_model.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/linear_solvers.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

using fixtures::code_of;
using fixtures::free_model;
using fixtures::interface_nodes;
using fixtures::select_nodes;
using fixtures::two_tissue_model;

constexpr double direct_tolerance = 1e-10;  ///< rounding of two factorisations
constexpr double device_tolerance = 1e-6;   ///< residuals of 1e-8 times the condition number

struct Scene {
    Model model = two_tissue_model({6, 7, 6});
    std::vector<Index> observed = interface_nodes(model.mesh);
    std::vector<Index> driven =
        select_nodes(model.mesh, [](const Vec3& p) { return p.z() > 59.9 && p.x() < 45; });
};

Eigen::VectorXd random_values(Index count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    Eigen::VectorXd values(count);
    for (double& v : values) v = value(random);
    return values;
}

/// Observed displacement from the whole mesh with the driven nodes prescribed.
Eigen::VectorXd full_answer(Model model, const Scene& scene, const Eigen::VectorXd& driven) {
    fixtures::prescribe(model, scene.driven);
    Columns b = Columns::Zero(model.num_dofs(), 1), x;
    for (std::size_t i = 0; i < scene.driven.size(); ++i)
        for (Index c = 0; c < 3; ++c) b(3 * scene.driven[i] + c, 0) = driven[3 * i + c];
    LinearSolverOptions options = fixtures::solver_on("reference");
    options.relative_tolerance = 1e-13;
    make_linear_solver(model, options)->solve(b, x);
    Eigen::VectorXd observed(3 * scene.observed.size());
    for (std::size_t i = 0; i < scene.observed.size(); ++i)
        for (Index c = 0; c < 3; ++c) observed[3 * i + c] = x(3 * scene.observed[i] + c, 0);
    return observed;
}

/// The same from (sum E_r S_r,oo) u_o = -(sum E_r S_r,od) u_d.
Eigen::VectorXd condensed_answer(const Model& model, const Scene& scene,
                                 const std::vector<CondensedRegion>& regions,
                                 const Eigen::VectorXd& driven) {
    Eigen::MatrixXd s_oo =
        Eigen::MatrixXd::Zero(3 * scene.observed.size(), 3 * scene.observed.size());
    Eigen::MatrixXd s_od =
        Eigen::MatrixXd::Zero(3 * scene.observed.size(), 3 * scene.driven.size());
    for (const CondensedRegion& r : regions) {
        const double stiffness = model.materials[r.region].stiffness_kpa;
        for (std::size_t i = 0; i < r.observed.size(); ++i) {
            for (std::size_t j = 0; j < r.observed.size(); ++j)
                s_oo.block<3, 3>(3 * r.observed[i], 3 * r.observed[j]) +=
                    stiffness * r.observed_observed.block<3, 3>(3 * i, 3 * j);
            for (std::size_t j = 0; j < r.driven.size(); ++j)
                s_od.block<3, 3>(3 * r.observed[i], 3 * r.driven[j]) +=
                    stiffness * r.observed_driven.block<3, 3>(3 * i, 3 * j);
        }
    }
    return -s_oo.partialPivLu().solve(s_od * driven);
}

class Condense : public testing::TestWithParam<std::string> {};

TEST_P(Condense, GivesTheAnswerOfTheFullModelAtRandomModuli) {
    if (const auto reason = fixtures::reason_to_skip(GetParam())) GTEST_SKIP() << *reason;
    Scene scene;
    const Eigen::VectorXd driven = random_values(3 * scene.driven.size(), 3);
    const double tolerance = GetParam() == "reference" ? direct_tolerance : device_tolerance;

    const auto regions = condense(solid_model_of(scene.model), scene.observed, scene.driven,
                                  fixtures::solver_on(GetParam()));

    ASSERT_EQ(regions.size(), 2u);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> log_stiffness(std::log(2.0), std::log(800.0));
    for (int trial = 0; trial < 4; ++trial) {
        for (LinearElastic& material : scene.model.materials)
            material.stiffness_kpa = std::exp(log_stiffness(random));
        const Eigen::VectorXd full = full_answer(scene.model, scene, driven);
        const Eigen::VectorXd condensed = condensed_answer(scene.model, scene, regions, driven);
        EXPECT_LT((full - condensed).norm(), tolerance * full.norm());
    }
}

TEST_P(Condense, ReportsEveryColumnAndTheWorstResidual) {
    if (const auto reason = fixtures::reason_to_skip(GetParam())) GTEST_SKIP() << *reason;
    const Scene scene;
    CondensationSummary summary;
    double last_fraction = 0;

    condense(solid_model_of(scene.model), scene.observed, scene.driven,
             fixtures::solver_on(GetParam()), &summary,
             [&](const Progress& p) { last_fraction = p.fraction; });

    EXPECT_EQ(summary.columns, 2 * 3 * static_cast<Index>(scene.observed.size()));
    EXPECT_TRUE(summary.linear.converged);
    EXPECT_GT(summary.linear.relative_residual, 0);
    EXPECT_LE(summary.linear.relative_residual, 1e-8);
    EXPECT_EQ(last_fraction, 1);
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, Condense, testing::ValuesIn(fixtures::backend_names()),
                         [](const auto& entry) { return entry.param; });

TEST(CondenseReference, IsTheElementMatrixWhereThereIsNoInterior) {
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
    mesh.tets = {{0, 1, 2, 3}};
    mesh.region = {0};
    const Model model = free_model(mesh, {{30.0, 0.25}});

    const auto regions =
        condense(solid_model_of(model), {2, 0}, {1, 3}, fixtures::solver_on("reference"));

    ASSERT_EQ(regions.size(), 1u);
    const Eigen::MatrixXd& s = regions[0].observed_observed;
    EXPECT_EQ(regions[0].observed, (std::vector<Index>{0, 1}));
    ASSERT_EQ(s.rows(), 6);
    // Node 2 moves along y only: V (lambda + 2 mu) / h^2 with V = h^3 / 6, lambda = mu = 0.4 E.
    EXPECT_NEAR(s(1, 1), 10.0 / 6 * 3 * 0.4, 1e-12);
    // A shift of all four nodes makes no force.
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(6, 3);
    for (int n = 0; n < 2; ++n)
        rows += s.middleCols<3>(3 * n) + regions[0].observed_driven.middleCols<3>(3 * n);
    EXPECT_LT(rows.norm(), 1e-13);
}

TEST(CondenseReference, LeavesOutRegionsWithoutObservedNodes) {
    Scene scene;
    for (Index t = 0; t < scene.model.mesh.num_tets(); ++t) {
        Vec3 highest = Vec3::Zero();
        for (Index n : scene.model.mesh.tets[t])
            highest = highest.cwiseMax(scene.model.mesh.nodes[n]);
        if (highest.z() < 15 && highest.y() < 15) scene.model.mesh.region[t] = 2;
    }
    scene.model.materials.push_back({5.0, 0.3});
    for (Index n : interface_nodes(scene.model.mesh))
        if (!std::binary_search(scene.observed.begin(), scene.observed.end(), n) &&
            !scene.model.prescribed[3 * n])
            scene.driven.push_back(n);

    const auto regions = condense(solid_model_of(scene.model), scene.observed, scene.driven,
                                  fixtures::solver_on("reference"));

    ASSERT_EQ(regions.size(), 2u);
    EXPECT_EQ(regions[0].region, 0);
    EXPECT_EQ(regions[1].region, 1);
}

TEST(CondenseReference, RefusesAFloatingPart) {
    Scene scene;
    Mesh& mesh = scene.model.mesh;
    const Index first = mesh.num_nodes();
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
        mesh.nodes.push_back(p + Vec3(500, 0, 0));
    mesh.tets.push_back({first, first + 1, first + 2, first + 3});
    mesh.region.push_back(0);
    scene.model.prescribed.resize(3 * mesh.nodes.size(), 0);

    const auto code = code_of([&] {
        condense(solid_model_of(scene.model), scene.observed, scene.driven,
                 fixtures::solver_on("reference"));
    });

    EXPECT_EQ(code, ErrorCode::solve_failed);
}

TEST(CondenseReference, RefusesARegionBorderThatIsNotObserved) {
    Scene scene;
    scene.observed.pop_back();

    const auto code = code_of([&] {
        condense(solid_model_of(scene.model), scene.observed, scene.driven,
                 fixtures::solver_on("reference"));
    });

    EXPECT_EQ(code, ErrorCode::invalid_argument);
}

TEST(CondenseReference, RefusesANodeThatIsObservedAndDriven) {
    Scene scene;
    scene.driven.push_back(scene.observed.front());

    const auto code = code_of([&] {
        condense(solid_model_of(scene.model), scene.observed, scene.driven,
                 fixtures::solver_on("reference"));
    });

    EXPECT_EQ(code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace palpate

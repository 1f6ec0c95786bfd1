// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/direct.hpp"

#include <gtest/gtest.h>

#include "solver/linear/factor_libraries.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

using fixtures::code_of;

TEST(DirectSolver, StretchesABarByForceOverStiffness) {
    // 10 x 10 x 40 mm, E = 20 kPa, pulled with 100 mN at z = 40; sides free, nu = 0: u = F L / (E
    // A).
    Model model = fixtures::free_model(fixtures::box_mesh({2, 2, 8}, {10, 10, 40}), {{20.0, 0.0}});
    fixtures::prescribe(
        model, fixtures::select_nodes(model.mesh, [](const Vec3& p) { return p.z() == 0; }));
    // All nodes of the end move together: the force goes to where the area says.
    Columns b = Columns::Zero(model.num_dofs(), 1), x;
    const double share = 100.0 / 4;  // per square of the 2 x 2 end face
    for (Index i = 0; i < 2; ++i)
        for (Index j = 0; j < 2; ++j) {
            // The diagonal of each square runs from its low to its high corner.
            const auto node = [&](Index di, Index dj) { return 9 * 8 + i + di + 3 * (j + dj); };
            b(3 * node(0, 0) + 2, 0) += share / 3;
            b(3 * node(1, 1) + 2, 0) += share / 3;
            b(3 * node(1, 0) + 2, 0) += share / 6;
            b(3 * node(0, 1) + 2, 0) += share / 6;
        }

    const auto summary = make_direct_solver(model, {})->solve(b, x);

    EXPECT_TRUE(summary.converged);
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        EXPECT_NEAR(x(3 * n + 2, 0), 100.0 / (20.0 * 100.0) * model.mesh.nodes[n].z(), 1e-11);
        EXPECT_NEAR(x(3 * n, 0), 0, 1e-11);
    }
}

class DirectLibrary : public testing::TestWithParam<std::string> {};

TEST_P(DirectLibrary, RefusesAModelThatCanMoveRigidly) {
    LinearSolverOptions options;
    options.direct_library = GetParam();
    Model model = fixtures::two_tissue_model({3, 3, 3});
    std::fill(model.prescribed.begin(), model.prescribed.end(), 0);
    EXPECT_EQ(code_of([&] { make_direct_solver(model, options); }), ErrorCode::solve_failed);

    fixtures::prescribe(model, {0});  // it can still turn round this node
    EXPECT_EQ(code_of([&] { make_direct_solver(model, options); }), ErrorCode::solve_failed);
}

INSTANTIATE_TEST_SUITE_P(EveryLibrary, DirectLibrary, testing::ValuesIn(sparse_factor_names()),
                         [](const auto& entry) { return entry.param; });

TEST(DirectSolver, AcceptsAModelWithEveryNodePrescribed) {
    Model model = fixtures::two_tissue_model({2, 2, 2});
    std::fill(model.prescribed.begin(), model.prescribed.end(), 1);
    const Columns b = fixtures::random_columns(model.num_dofs(), 3, 1);
    Columns x;

    const auto summary = make_direct_solver(model, {})->solve(b, x);

    EXPECT_TRUE(summary.converged);
    EXPECT_EQ(x, b);
}

TEST(DirectSolver, LeavesNodesWithoutElementsAlone) {
    Model model = fixtures::two_tissue_model({3, 3, 3});
    Columns b = fixtures::random_columns(model.num_dofs(), 1, 2), expected, x;
    make_direct_solver(model, {})->solve(b, expected);
    model.mesh.nodes.push_back({500, 0, 0});
    model.prescribed.resize(3 * model.mesh.nodes.size(), 0);
    b.conservativeResize(model.num_dofs(), 1);
    b.bottomRows<3>().setZero();

    const auto summary = make_direct_solver(model, {})->solve(b, x);

    EXPECT_TRUE(summary.converged);
    EXPECT_LT((x.topRows(expected.rows()) - expected).norm(), 1e-9 * expected.norm());
    EXPECT_TRUE(x.bottomRows<3>().isZero(0));
}

}  // namespace
}  // namespace palpate

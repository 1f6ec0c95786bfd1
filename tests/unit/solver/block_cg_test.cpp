// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/block_cg.hpp"

#include <gtest/gtest.h>

#include "solver/backend/registry.hpp"
#include "solver/linear/make_linear_solver.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

struct Fixture {
    Model model = fixtures::two_tissue_model({4, 4, 5});
    std::unique_ptr<Backend> backend = make_backend("reference", {});
    std::unique_ptr<Preconditioner> jacobi;
    Fixture() {
        backend->prepare(model);
        jacobi = make_block_jacobi(*backend, backend->stiffness());
    }

    Columns rhs(Index columns) const {
        Columns b = fixtures::random_columns(model.num_dofs(), columns, 1);
        for (Index d = 0; d < model.num_dofs(); ++d)
            if (model.prescribed[d]) b.row(d).setZero();
        return b;
    }
};

TEST(BlockCg, GivesAColumnTheSameAnswerAloneAndAmongOthers) {
    Fixture f;
    Columns b = f.rhs(3);
    b.col(2) *= 1e-3;  // converges at another iteration than the others
    const std::vector<double> target = {1e-9, 1e-2, 1e-5};
    Columns together, alone;

    BlockCg(*f.backend, *f.jacobi).solve(b, target, 1000, together);

    for (Index c = 0; c < 3; ++c) {
        BlockCg(*f.backend, *f.jacobi)
            .solve(b.col(c), std::span(target).subspan(c, 1), 1000, alone);
        EXPECT_LT((alone - together.col(c)).norm(), 1e-12 * alone.norm());
    }
}

TEST(BlockCg, StopsAtTheLimitOfIterations) {
    Fixture f;
    const std::vector<double> target = {1e-12};
    Columns dx;

    const int iterations = BlockCg(*f.backend, *f.jacobi).solve(f.rhs(1), target, 7, dx);

    EXPECT_EQ(iterations, 7);
    EXPECT_GT(dx.norm(), 0);
}

TEST(BlockCg, DoesNothingForColumnsThatAreSmallEnough) {
    Fixture f;
    const std::vector<double> target = {1e6, 1e6};
    Columns dx;

    const int iterations = BlockCg(*f.backend, *f.jacobi).solve(f.rhs(2), target, 100, dx);

    EXPECT_EQ(iterations, 0);
    EXPECT_TRUE(dx.isZero(0));
}

TEST(BlockCg, GoesOnWithTheOpenColumnsInNarrowerVectors) {
    Fixture f;
    const Columns b = f.rhs(9);
    std::vector<double> target(9, 1e-1);  // most are done early, two need many iterations
    target[3] = target[7] = 1e-11;
    Columns together, alone;

    const int iterations = BlockCg(*f.backend, *f.jacobi).solve(b, target, 1000, together);

    EXPECT_GT(iterations, 20);
    for (Index c = 0; c < 9; ++c) {
        BlockCg(*f.backend, *f.jacobi)
            .solve(b.col(c), std::span(target).subspan(c, 1), 1000, alone);
        const double tolerance = target[c] < 1e-2 ? 1e-9 : 1e-1;
        EXPECT_LT((alone - together.col(c)).norm(), tolerance * alone.norm()) << c;
    }
}

TEST(BlockCg, PadsToWidthsWithWideLoads) {
    EXPECT_EQ(padded_columns(1), 1);
    EXPECT_EQ(padded_columns(2), 4);
    EXPECT_EQ(padded_columns(5), 8);
    EXPECT_EQ(padded_columns(16), 16);
    EXPECT_EQ(padded_columns(17), 32);
    EXPECT_EQ(padded_columns(33), 48);
}

TEST(CgSolver, SaysSoWhenItStopsAboveTheTolerance) {
    const Fixture f;
    LinearSolverOptions options;
    options.backend = "reference";
    options.method = LinearMethod::jacobi;
    options.max_iterations = 3;
    options.max_refinements = 2;
    Columns x;

    const auto summary = make_linear_solver(f.model, options)->solve(f.rhs(2), x);

    EXPECT_FALSE(summary.converged);
    EXPECT_GT(summary.relative_residual, options.relative_tolerance);
    EXPECT_EQ(summary.refinements, 2);
    EXPECT_EQ(summary.iterations, 6);
    EXPECT_FALSE(summary.message.empty());
}

}  // namespace
}  // namespace palpate

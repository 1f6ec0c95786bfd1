// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/linear_problem.hpp"

#include <gtest/gtest.h>

#include "solver/linear/make_linear_solver.hpp"
#include "tests/fixtures/columns.hpp"

namespace palpate::bench {
namespace {

constexpr double rounding = 1e-12;  // relative, of sums of some hundred products in fp64

const BenchMesh& box() { return bench_mesh("", "box"); }

/// K x of the matrix that peers get.
Columns multiply(const FreeMatrix& matrix, const Columns& x) {
    Columns y = Columns::Zero(x.rows(), x.cols());
    for (Index row = 0; row < matrix.num_rows(); ++row)
        for (Index k = matrix.offsets[row]; k < matrix.offsets[row + 1]; ++k)
            y.row(row) += matrix.values[k] * x.row(matrix.columns[k]);
    return y;
}

TEST(FreeMatrix, AgreesWithElementForcesOnFreeDofs) {
    const FreeMatrix matrix = assemble_free_matrix(box().model);
    Columns u = Columns::Zero(box().model.num_dofs(), 3);
    u(matrix.dofs, Eigen::all) = fixtures::random_columns(matrix.num_rows(), 3, 1);

    const Columns by_elements = internal_forces(box().model, u)(matrix.dofs, Eigen::all);
    const Columns by_matrix = multiply(matrix, u(matrix.dofs, Eigen::all));

    EXPECT_LT((by_elements - by_matrix).norm(), rounding * by_elements.norm());
}

TEST(FreeMatrix, RefusesNodesThatArePrescribedInPart) {
    Model model = box().model;
    model.prescribed.assign(model.prescribed.size(), 0);
    model.prescribed[3] = 1;

    EXPECT_EQ(fixtures::code_of([&] { assemble_free_matrix(model); }), ErrorCode::unsupported);
}

TEST(LinearProblem, StartsWithTheSameColumnsWhateverTheirNumber) {
    const LinearProblem few = make_linear_problem(box(), 2), many = make_linear_problem(box(), 5);

    EXPECT_EQ(few.b, many.b.leftCols(2));
}

TEST(LinearProblem, BalancesBodyForcesAndWhatTheWallsInduce) {
    const LinearProblem problem = make_linear_problem(box(), 3);
    Columns body = problem.b;
    for (Index d = 0; d < body.rows(); ++d)
        if (box().model.prescribed[d]) body.row(d).setZero();
    const Columns induced = free_rhs(box().model, problem.b) - body;

    for (Index c = 0; c < 3; ++c)
        EXPECT_NEAR(body.col(c).norm() / induced.col(c).norm(), 1, rounding);
}

TEST(RelativeResidual, IsSmallForTheAnswerAndOneForNone) {
    const LinearProblem problem = make_linear_problem(box(), 2);
    LinearSolverOptions options;
    options.backend = "reference";
    options.method = LinearMethod::direct;
    Columns x;
    make_linear_solver(box().model, options)->solve(problem.b, x);
    Columns nothing = x;
    for (Index d = 0; d < x.rows(); ++d)
        if (!box().model.prescribed[d]) nothing.row(d).setZero();

    EXPECT_LT(relative_residual(box().model, problem, x), rounding);
    EXPECT_NEAR(relative_residual(box().model, problem, nothing), 1, rounding);
}

TEST(RelativeResidual, IsInfiniteWhereAPrescribedDisplacementIsMissed) {
    const LinearProblem problem = make_linear_problem(box(), 1);

    const Columns zero = Columns::Zero(problem.b.rows(), 1);

    EXPECT_TRUE(std::isinf(relative_residual(box().model, problem, zero)));
}

}  // namespace
}  // namespace palpate::bench

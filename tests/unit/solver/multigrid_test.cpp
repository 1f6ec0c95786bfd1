// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/multigrid/multigrid.hpp"

#include <gtest/gtest.h>

#include "solver/backend/registry.hpp"
#include "solver/linear/make_linear_solver.hpp"
#include "solver/model/stiffness_matrix.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"

// What makes it multigrid: the number of iterations. On the reference back end, in fp64.
namespace palpate {
namespace {

int iterations(const Model& model) {
    LinearSolverOptions options;
    options.backend = "reference";
    options.method = LinearMethod::multigrid;
    Columns b = fixtures::random_columns(model.num_dofs(), 1, 1);
    Columns x;
    const LinearSolverSummary summary = make_linear_solver(model, options)->solve(b, x);
    EXPECT_TRUE(summary.converged) << summary.message;
    return summary.iterations;
}

TEST(Multigrid, NeedsAboutAsManyIterationsOnAFinerMesh) {
    const int coarse = iterations(fixtures::two_tissue_model({8, 8, 8}));
    const int fine = iterations(fixtures::two_tissue_model({22, 22, 22}));

    EXPECT_LE(fine, 1.3 * coarse) << coarse;
    EXPECT_LT(fine, 30);
}

TEST(Multigrid, StaysBelowTwiceTheHomogeneousCountForStiffInclusions) {
    Model model = fixtures::two_tissue_model({14, 14, 14});
    for (LinearElastic& m : model.materials) m = {10, 0.4};
    const int homogeneous = iterations(model);
    for (double ratio : {0.01, 0.1, 10.0, 100.0}) {
        model.materials[1].stiffness_kpa = 10 * ratio;
        EXPECT_LT(iterations(model), 2 * homogeneous) << ratio;
    }
}

TEST(Multigrid, CycleIsSymmetricAndPositive) {
    const Model model = fixtures::two_tissue_model({9, 10, 11});
    const auto backend = make_backend("reference", {});
    backend->prepare(model);
    const Hierarchy hierarchy(model, assemble_stiffness(model));
    Multigrid multigrid(*backend, hierarchy);
    const Index rows = model.num_dofs(), columns = 6;
    const Columns r = fixtures::random_columns(rows, columns, 2);
    const auto in = backend->make_vector(rows, columns), out = backend->make_vector(rows, columns);
    const auto sums = backend->make_sums(columns);
    backend->copy_in({r.data(), static_cast<std::size_t>(r.size())}, *in);

    multigrid.apply(*in, *out, *sums);

    Columns z(rows, columns);
    backend->copy_out(*out, {z.data(), static_cast<std::size_t>(z.size())});
    std::vector<double> rz(columns);
    backend->read(*sums, rz);
    const Eigen::MatrixXd gram = r.transpose() * z;
    EXPECT_LT((gram - gram.transpose()).norm(), 1e-10 * gram.norm());
    for (Index c = 0; c < columns; ++c) {
        EXPECT_GT(gram(c, c), 0);
        EXPECT_NEAR(rz[c], gram(c, c), 1e-12 * gram(c, c));
    }
}

TEST(Multigrid, SolvesATinyModelByItsInverse) {
    EXPECT_LE(iterations(fixtures::two_tissue_model({3, 3, 3})), 4);  // checked every four
}

}  // namespace
}  // namespace palpate

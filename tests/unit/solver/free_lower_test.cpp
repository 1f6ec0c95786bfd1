// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/free_lower.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/equilibrium/solid_assembly.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

/// By definition, entry by entry.
Eigen::MatrixXd expected_lower(const BlockMatrix& matrix, const FreeDofs& free, double shift) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(free.count, free.count);
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    const Index row = free.number[3 * n + i],
                                column = free.number[3 * matrix.graph.items[k] + j];
                    if (row >= column && column >= 0)
                        dense(row, column) = matrix.block(k)[3 * i + j];
                }
    const double size = dense.diagonal().cwiseAbs().mean();
    dense.diagonal().array() += shift * size;
    return dense;
}

TEST(FreeLower, HasTheEntriesOfOneMatrixAfterAnother) {
    SolidModel model = fixtures::solid_models()[0];
    for (const std::size_t dof : {0u, 4u, 17u}) model.prescribed[dof] = 1;
    const SolidAssembly solid(model);
    BlockMatrix matrix = solid.make_matrix();
    const FreeDofs free = number_free_dofs(matrix.graph, model.prescribed);
    ASSERT_EQ(free.count, model.num_dofs() - 3);
    FreeLower lower(matrix.graph, free);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(model.num_dofs());
    for (const double shift : {0.0, 0.1, 0.0}) {
        solid.tangent(u, matrix);
        const Eigen::MatrixXd expected = expected_lower(matrix, free, shift);
        EXPECT_LT((Eigen::MatrixXd(lower.fill(matrix, shift)) - expected).norm(),
                  1e-13 * expected.norm());
        for (Eigen::Index d = 0; d < u.size(); ++d) u[d] += 1e-3 * std::sin(1.0 * d);
    }
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/multigrid/block_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>

namespace palpate {
namespace {

using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int modes = 6;
constexpr double omega = 0.7;

Eigen::Map<const Dense> block_of(const BlockMatrix& matrix, Index k) {
    return {matrix.block(k), matrix.block_rows, matrix.block_columns};
}

Dense dense(const BlockMatrix& matrix) {
    Dense all = Dense::Zero(matrix.num_rows() * matrix.block_rows,
                            matrix.num_columns * matrix.block_columns);
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
            all.block(n * matrix.block_rows, matrix.graph.items[k] * matrix.block_columns,
                      matrix.block_rows, matrix.block_columns) = block_of(matrix, k);
    return all;
}

BlockMatrix matrix_of(Adjacency graph, Index columns, int rows, int width) {
    BlockMatrix matrix;
    matrix.graph = std::move(graph);
    matrix.num_columns = columns;
    matrix.block_rows = rows;
    matrix.block_columns = width;
    matrix.blocks.assign(matrix.graph.items.size() * matrix.block_size(), -99.0);
    return matrix;
}

/// Nodes 0 - 1 - 2 - 3 in a row; 0 and 1 are aggregate 0, 2 aggregate 1, 3 none.
struct Case {
    int b;
    std::mt19937 engine{17};
    std::normal_distribution<double> normal;
    BlockMatrix a;
    std::vector<Index> of_node{0, 0, 1, -1};
    std::vector<double> tentative, inverse_diagonal;
    BlockMatrix p, c, coarse;

    explicit Case(int size) : b(size) {
        a = matrix_of({{0, 2, 5, 8, 10}, {0, 1, 0, 1, 2, 1, 2, 3, 2, 3}}, 4, b, b);
        const Dense root = random(4 * b, 4 * b);
        const Dense symmetric = root + root.transpose();
        for (Index n = 0; n < 4; ++n)
            for (Index k = a.graph.offsets[n]; k < a.graph.offsets[n + 1]; ++k)
                Eigen::Map<Dense>(a.block(k), b, b) =
                    symmetric.block(n * b, a.graph.items[k] * b, b, b);
        inverse_diagonal = numbers(4 * b * b);
        tentative = numbers(4 * b * modes);
        for (std::size_t k = 0; k < std::size_t(b) * modes; ++k)
            tentative[std::size_t(3) * b * modes + k] = 0;  // of no aggregate
        p = matrix_of({{0, 2, 4, 6, 6}, {0, 1, 0, 1, 0, 1}}, 2, b, modes);
        c = matrix_of({{0, 2, 4, 6, 6}, {0, 1, 0, 1, 0, 1}}, 2, b, modes);
        coarse = matrix_of({{0, 2, 4}, {0, 1, 0, 1}}, 2, modes, modes);
    }
    Dense random(Index rows, Index columns) {
        return Dense::NullaryExpr(rows, columns, [&] { return normal(engine); });
    }
    std::vector<double> numbers(std::size_t count) {
        std::vector<double> made(count);
        for (double& x : made) x = normal(engine);
        return made;
    }
    Dense dense_tentative() const {
        Dense t = Dense::Zero(4 * b, 2 * modes);
        for (Index n = 0; n < 3; ++n)
            t.block(n * b, of_node[n] * modes, b, modes) =
                Eigen::Map<const Dense>(&tentative[std::size_t(n) * b * modes], b, modes);
        return t;
    }
    Dense dense_inverse_diagonal() const {
        Dense d = Dense::Zero(4 * b, 4 * b);
        for (Index n = 0; n < 4; ++n)
            d.block(n * b, n * b, b, b) =
                Eigen::Map<const Dense>(&inverse_diagonal[std::size_t(n) * b * b], b, b);
        return d;
    }
};

class BlockKernels : public ::testing::TestWithParam<int> {};

TEST_P(BlockKernels, MultiplyRows) {
    Case f(GetParam());
    const Eigen::VectorXd x = f.random(4 * f.b, 1);
    Eigen::VectorXd y = Eigen::VectorXd::Constant(4 * f.b, 7.0);

    multiply_block_rows(f.a, 1, 3, x.data(), y.data());

    const Eigen::VectorXd all = dense(f.a) * x;
    EXPECT_LT((y.segment(f.b, 2 * f.b) - all.segment(f.b, 2 * f.b)).norm(), 1e-12 * all.norm());
    EXPECT_EQ(y.head(f.b), Eigen::VectorXd::Constant(f.b, 7.0)) << "rows before stay as they are";
    EXPECT_EQ(y.tail(f.b), Eigen::VectorXd::Constant(f.b, 7.0)) << "and those after";
}

TEST_P(BlockKernels, SmoothTheTentativeProlongation) {
    Case f(GetParam());
    const Dense t = f.dense_tentative();
    const Dense expected = t - omega * f.dense_inverse_diagonal() * dense(f.a) * t;

    smooth_prolongation(f.a, 0, 4, f.inverse_diagonal.data(), omega, f.of_node.data(),
                        f.tentative.data(), f.p);

    // The last node belongs to no aggregate: it has no row in P.
    EXPECT_LT((dense(f.p).topRows(3 * f.b) - expected.topRows(3 * f.b)).norm(),
              1e-12 * expected.norm());
    EXPECT_EQ(dense(f.p).bottomRows(f.b).norm(), 0);
}

TEST_P(BlockKernels, GalerkinProductIsThatOfDenseMatrices) {
    Case f(GetParam());
    smooth_prolongation(f.a, 0, 4, f.inverse_diagonal.data(), omega, f.of_node.data(),
                        f.tentative.data(), f.p);
    const Adjacency members{{0, 3, 6}, {0, 1, 2, 0, 1, 2}};
    const std::vector<Index> entries{0, 2, 4, 1, 3, 5};

    multiply_prolongation(f.a, f.p, 0, 4, f.c);
    multiply_restriction(f.p, members, entries.data(), f.c, 0, 2, f.coarse);
    mirror_upper_triangle(f.coarse, 0, 2);

    const Dense p = dense(f.p), product = dense(f.a) * p;
    EXPECT_LT((dense(f.c).topRows(3 * f.b) - product.topRows(3 * f.b)).norm(),
              1e-12 * product.norm());
    const Dense galerkin = p.transpose() * product;
    EXPECT_LT((dense(f.coarse) - galerkin).norm(), 1e-12 * galerkin.norm());
}

INSTANTIATE_TEST_SUITE_P(BlockSizes, BlockKernels, ::testing::Values(3, 6));

}  // namespace
}  // namespace palpate

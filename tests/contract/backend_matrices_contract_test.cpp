// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "tests/contract/backend_contract.hpp"

// Operators made from block matrices.
namespace palpate::backend_contract {
namespace {

struct Shape {
    Index rows, columns;
    int block_rows, block_columns;
};

const std::vector<Shape> matrix_shapes = {
    {257, 257, 3, 3}, {129, 129, 6, 6}, {257, 43, 3, 6}, {43, 257, 6, 3}, {11, 1, 2, 1}};

TEST_P(BackendContract, MultipliesWithAnyBlockMatrix) {
    for (const Shape& shape : matrix_shapes) {
        const BlockMatrix matrix =
            random_matrix(shape.rows, shape.columns, shape.block_rows, shape.block_columns, 240);
        const auto a = backend_->make_operator(matrix, {});
        const auto expected = oracle_->make_operator(matrix, {});

        EXPECT_EQ(a->rows(), shape.rows * shape.block_rows);
        EXPECT_EQ(a->columns(), shape.columns * shape.block_columns);
        expect_same_products(*a, *expected, 241);
    }
}

TEST_P(BackendContract, SmoothesWithASquareBlockMatrix) {
    for (int block : {1, 3, 6}) {
        const BlockMatrix matrix = random_matrix(137, 137, block, block, 250);
        const std::vector<double> diagonal = random_diagonal(matrix, 252);
        const auto a = backend_->make_operator(matrix, diagonal);
        const auto expected = oracle_->make_operator(matrix, diagonal);

        expect_same_smoothing(*a, *expected, 253);
        expect_right_sums(*a, 260);
    }
}

TEST_P(BackendContract, ScalesAVectorInPlace) {
    const BlockMatrix matrix = random_matrix(137, 137, 3, 3, 265);
    const auto a = backend_->make_operator(matrix, random_diagonal(matrix, 266));
    for (Index columns : column_counts) {
        const Columns r = random_columns(411, columns, 267);
        const auto there = to_device(*backend_, r), here = to_device(*backend_, r);
        const auto z = nan_vector(*backend_, 411, columns);
        const auto sums = backend_->make_sums(columns);

        backend_->apply_inverse_diagonal(*a, 0.7, *there, *z);
        backend_->apply_inverse_diagonal(*a, 0.7, *here, *here, sums.get());

        EXPECT_EQ(to_host(*backend_, *here), to_host(*backend_, *z));
        expect_sums(*sums, r, to_host(*backend_, *z));
    }
}

TEST_P(BackendContract, TakesNewValuesInTheSamePattern) {
    BlockMatrix matrix = random_matrix(137, 137, 6, 6, 270);
    const auto a = backend_->make_operator(matrix, random_diagonal(matrix, 272));
    const auto expected = oracle_->make_operator(matrix, random_diagonal(matrix, 272));
    matrix.blocks = random_numbers(matrix.blocks.size(), 273);
    const std::vector<double> diagonal = random_diagonal(matrix, 274);

    backend_->set_values(*a, matrix, diagonal);
    oracle_->set_values(*expected, matrix, diagonal);

    expect_same_products(*a, *expected, 275);
    expect_same_smoothing(*a, *expected, 280);
}

TEST_P(BackendContract, MultipliesWithAMatrixWithoutBlocks) {
    BlockMatrix matrix;
    matrix.num_columns = 4;
    matrix.graph.offsets.assign(6, 0);
    const auto a = backend_->make_operator(matrix, {});
    const auto y = nan_vector(*backend_, 15, 3);

    backend_->apply(*a, *to_device(*backend_, random_columns(12, 3, 290)), *y);

    EXPECT_TRUE(to_host(*backend_, *y).isZero(0));
}

}  // namespace
}  // namespace palpate::backend_contract

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/discrepancy.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "host/estimate/block_covariance.hpp"
#include "host/estimate/learn_discrepancy.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

/// Columns at places along x, at each of some times.
DataBlock grid_block(Index num_place, Index num_time) {
    DataBlock block = toy_block(Eigen::VectorXd::Zero(num_place * num_time), 0.5);
    block.position_mm.resize(block.num_row(), 1);
    block.time_s.resize(block.num_row());
    for (Index i = 0; i < block.num_row(); ++i) {
        block.position_mm(i, 0) = 0.4 * (i % num_place);
        block.time_s[i] = 0.1 * (i / num_place);
    }
    return block;
}

Eigen::MatrixXd dense_correlation(const DataBlock& block, double length_mm, double length_s) {
    const Index count = block.num_row();
    Eigen::MatrixXd correlation = Eigen::MatrixXd::Ones(count, count);
    for (Index i = 0; i < count; ++i)
        for (Index j = 0; j < count; ++j) {
            if (block.position_mm.cols() > 0)
                correlation(i, j) *= matern(
                    (block.position_mm.row(i) - block.position_mm.row(j)).norm() / length_mm);
            if (block.time_s.size() > 0)
                correlation(i, j) *= matern(std::abs(block.time_s[i] - block.time_s[j]) / length_s);
        }
    return correlation;
}

/// Largest relative error of C^-1 v and of ln det C against a dense C.
void expect_dense(const DataBlock& block, const Eigen::VectorXd& variance, double tolerance) {
    constexpr double amplitude = 1.5, length_mm = 2, length_s = 1;
    const auto basis = std::make_shared<const DiscrepancyBasis>(
        RowGrid(block).basis(length_mm, length_s, block.num_row()));
    const BlockCovariance covariance(variance, amplitude, basis);
    Eigen::MatrixXd dense = amplitude * amplitude * dense_correlation(block, length_mm, length_s);
    dense.diagonal() += variance;
    std::mt19937 random(3);
    Eigen::VectorXd right(block.num_row());
    for (auto& number : right) number = std::normal_distribution<double>()(random);
    const Eigen::LLT<Eigen::MatrixXd> factor(dense);
    const Eigen::VectorXd expected = factor.solve(right);

    EXPECT_LT((covariance.solve(right) - expected).norm(), tolerance * expected.norm());
    EXPECT_NEAR(covariance.log_determinant(), 2 * factor.matrixLLT().diagonal().array().log().sum(),
                tolerance * static_cast<double>(block.num_row()));
    EXPECT_LT((covariance.variances() - dense.diagonal()).norm(), 1e-3 * dense.diagonal().norm());
}

TEST(Discrepancy, TheKernelIsMaternThreeHalves) {
    EXPECT_EQ(matern(0), 1);
    EXPECT_NEAR(matern(1), (1 + std::sqrt(3.0)) * std::exp(-std::sqrt(3.0)), 1e-15);
}

TEST(Discrepancy, AGridHasTheCovarianceOfItsDenseMatrix) {
    const DataBlock block = grid_block(8, 30);

    expect_dense(block, Eigen::VectorXd::Constant(240, 0.25), 1e-2);
}

TEST(Discrepancy, OrthogonalModesTakeRowsThatCountLess) {
    const DataBlock block = grid_block(10, 110);  // enough rows for orthogonal modes
    Eigen::VectorXd variance = Eigen::VectorXd::Constant(block.num_row(), 0.25);
    for (Index i = 0; i < block.num_row(); i += 37) variance[i] = 9;

    EXPECT_TRUE(RowGrid(block).basis(2, 1, 256).is_orthogonal);
    expect_dense(block, variance, 5e-3);
}

TEST(Discrepancy, ScatteredRowsHaveTheCovarianceOfTheirDenseMatrix) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform;
    DataBlock block = toy_block(Eigen::VectorXd::Zero(150), 0.5);
    block.position_mm.resize(150, 3);
    for (auto& number : block.position_mm.reshaped()) number = 6 * uniform(random);

    expect_dense(block, Eigen::VectorXd::LinSpaced(150, 0.2, 0.6), 1e-3);
}

TEST(Discrepancy, RowsWithoutPlaceAndTimeHaveMoreIndependentNoise) {
    const DataBlock block = toy_block(Eigen::VectorXd::Zero(4), 0.5);
    const auto basis = std::make_shared<const DiscrepancyBasis>(RowGrid(block).basis(1, 1, 10));
    const BlockCovariance covariance(Eigen::VectorXd::Constant(4, 0.25), 2, basis);

    EXPECT_NEAR(covariance.solve(Eigen::VectorXd::Ones(4))(0, 0), 1 / 4.25, 1e-15);
}

TEST(Discrepancy, WhatModesMissCountsAsNoise) {
    const DataBlock block = grid_block(10, 60);
    const DiscrepancyBasis basis = RowGrid(block).basis(0.5, 0.2, 40);
    const Eigen::VectorXd variance = basis.modes.rowwise().squaredNorm() + basis.remainder;

    EXPECT_EQ(basis.modes.cols(), 40);
    EXPECT_NEAR(variance.mean(), 1, 1e-9);
    EXPECT_GT(basis.remainder.mean(), 0.1);
}

TEST(Discrepancy, ThinnedBlocksAreMeansOverNeighbouringTimes) {
    DataBlock block = grid_block(5, 40);
    block.measured = block.time_s;
    block.predicted = Eigen::VectorXd::Zero(200);
    block.columns = Eigen::MatrixXd::Ones(200, 2);

    const DataBlock mean = thinned_block(block, 60);

    EXPECT_EQ(mean.num_row(), 50);
    EXPECT_NEAR((mean.measured - mean.time_s).norm(), 0, 1e-12);
    EXPECT_NEAR(mean.sd[0], 0.25, 1e-12);  // of four rows
    EXPECT_EQ(RowGrid(mean).num_time(), 10);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/low_rank_update.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <vector>

namespace palpate {
namespace {

TEST(LowRankUpdate, TurnsSolvesWithAMatrixIntoThoseWithItsSum) {
    constexpr Eigen::Index size = 12;
    Eigen::MatrixXd s = Eigen::MatrixXd::Identity(size, size) * 3;
    for (Eigen::Index i = 1; i < size; ++i) s(i, i - 1) = s(i - 1, i) = -1;
    const std::vector<Index> rows{2, 7, 11};
    Eigen::Matrix3d n;
    n << 0, 2, -1, -2, 0, 0.5, 1, -0.5, 0;
    Eigen::MatrixXd whole = s;
    whole(rows, rows) += n;
    const Eigen::MatrixXd right = Eigen::MatrixXd::Random(size, 4), inverse = s.inverse();
    const LowRankUpdate update(rows, n, inverse(Eigen::all, rows));

    Eigen::MatrixXd x = inverse * right;
    update.apply(false, x);
    EXPECT_LT((whole * x - right).norm(), 1e-12 * right.norm());
    x = inverse * right;
    update.apply(true, x);
    EXPECT_LT((whole.transpose() * x - right).norm(), 1e-12 * right.norm());
    x = inverse * right;
    LowRankUpdate().apply(false, x);
    EXPECT_EQ(x, inverse * right);
}

}  // namespace
}  // namespace palpate

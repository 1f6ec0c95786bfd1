// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/low_rank_update.hpp"

#include <Eigen/LU>
#include <utility>

namespace palpate {

LowRankUpdate::LowRankUpdate(std::vector<Index> rows, const Eigen::MatrixXd& n,
                             Eigen::MatrixXd solved)
    : rows_(std::move(rows)), solved_(std::move(solved)) {
    const Eigen::MatrixXd reduced = solved_(rows_, Eigen::all);  // E^T Z
    for (const int k : {0, 1}) {
        const Eigen::MatrixXd signed_n = k == 0 ? n : Eigen::MatrixXd(-n);
        const Eigen::MatrixXd sum =
            Eigen::MatrixXd::Identity(n.rows(), n.cols()) + signed_n * reduced;
        small_[k] = sum.partialPivLu().solve(signed_n);
    }
}

void LowRankUpdate::apply(bool is_negative, Eigen::Ref<Eigen::MatrixXd> y) const {
    if (rows_.empty()) return;
    const Eigen::MatrixXd there = y(rows_, Eigen::all);  // E^T y
    y.noalias() -= solved_ * (small_[is_negative ? 1 : 0] * there);
}

}  // namespace palpate

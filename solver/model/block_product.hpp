// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solver/model/block_matrix.hpp"

namespace palpate {

/// A x for a matrix of 3x3 blocks; x [3 num_columns, any number of columns].
inline Eigen::MatrixXd times(const BlockMatrix& a, const Eigen::MatrixXd& x) {
    using Block = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(3 * a.num_rows(), x.cols());
    for (Eigen::Index c = 0; c < x.cols(); ++c)
        for (Index n = 0; n < a.num_rows(); ++n)
            for (Index k = a.graph.offsets[n]; k < a.graph.offsets[n + 1]; ++k)
                y.col(c).segment<3>(3 * n) +=
                    Block(a.block(k)) * x.col(c).segment<3>(3 * a.graph.items[k]);
    return y;
}

}  // namespace palpate

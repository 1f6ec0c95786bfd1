// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/column_basis.hpp"

#include <cmath>

namespace palpate {

Eigen::MatrixXd ColumnSelection::columns_of(const Eigen::MatrixXd& matrix) const {
    Eigen::MatrixXd chosen = matrix(Eigen::all, columns);
    lower.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(chosen);
    return chosen;
}

Eigen::MatrixXd ColumnSelection::rows_of(const Eigen::MatrixXd& matrix) const {
    Eigen::MatrixXd chosen = matrix(columns, Eigen::all);
    lower.triangularView<Eigen::Lower>().solveInPlace(chosen);
    return chosen;
}

ColumnSelection select_columns(const Eigen::MatrixXd& gram, double tolerance) {
    const Eigen::Index n = gram.rows();
    Eigen::VectorXd left = gram.diagonal();
    // Rounding in the Gram matrix hides what is smaller than this.
    const double floor = n == 0 ? 0 : 1e-13 * left.maxCoeff();
    ColumnSelection kept;
    Eigen::MatrixXd rows(n, n);  // column k: the k-th column of L, by column of X
    Eigen::Index rank = 0, pivot = 0;
    while (rank < n && left.sum() > tolerance * tolerance && left.maxCoeff(&pivot) > floor) {
        auto next = rows.col(rank);
        next.noalias() =
            gram.col(pivot) - rows.leftCols(rank) * rows.row(pivot).head(rank).transpose();
        next /= std::sqrt(left[pivot]);
        left = (left - next.cwiseAbs2()).cwiseMax(0.0);
        left[pivot] = 0;
        kept.columns.push_back(pivot);
        ++rank;
    }
    kept.root = rows.leftCols(rank);
    kept.lower = kept.root(kept.columns, Eigen::all);
    return kept;
}

Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& matrix, double tolerance) {
    const Eigen::MatrixXd gram = matrix.transpose() * matrix;
    Eigen::MatrixXd basis = select_columns(gram, tolerance).columns_of(matrix);
    // The Gram matrix squares the condition number; a second pass restores orthogonality.
    const Eigen::MatrixXd again = basis.transpose() * basis;
    return select_columns(again, 1e-3).columns_of(basis);
}

Eigen::MatrixXd extended_basis(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& matrix,
                               double tolerance) {
    if (basis.cols() == 0) return orthonormal_columns(matrix, tolerance);
    Eigen::MatrixXd rest = matrix;
    for (int pass = 0; pass < 2; ++pass) rest -= basis * (basis.transpose() * rest);
    Eigen::MatrixXd added = orthonormal_columns(rest, tolerance);
    added -= basis * (basis.transpose() * added);
    Eigen::MatrixXd result(basis.rows(), basis.cols() + added.cols());
    result << basis, added;
    return result;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate {

/// Columns of a matrix X that span the others up to a tolerance, found on its Gram matrix X^T X by
/// Cholesky factorisation with diagonal pivoting (Harbrecht, Peters and Schneider 2012).
struct ColumnSelection {
    std::vector<Eigen::Index> columns;  ///< in the order of their choice
    Eigen::MatrixXd
        root;  ///< [columns of X, chosen] R with R R^T = Gram matrix up to the tolerance
    Eigen::MatrixXd lower;  ///< its rows for the chosen columns, lower triangular

    /// X[:, columns] L^-T: orthonormal columns in the inner product of the Gram matrix.
    Eigen::MatrixXd columns_of(const Eigen::MatrixXd& matrix) const;
    /// The same for rows: L^-1 X[columns, :].
    Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix) const;
};

/// Stops when the root of the sum of squares of what all columns keep outside the span of those
/// chosen is at most `tolerance`.
ColumnSelection select_columns(const Eigen::MatrixXd& gram, double tolerance);

/// Orthonormal basis of the columns of `matrix`, up to `tolerance` in the Frobenius norm.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& matrix, double tolerance);

/// `basis` (orthonormal columns, or empty) and what `matrix` adds to it.
Eigen::MatrixXd extended_basis(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& matrix,
                               double tolerance);

}  // namespace palpate

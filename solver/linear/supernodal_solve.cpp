// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/supernodal_solve.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

namespace palpate {
namespace {

// x with its column index fastest is x^T to BLAS, [width, n]: the rows of a supernode's own columns
// stand side by side there, and every other row is one short run to gather or to scatter. A single
// column has its own type, so that Eigen calls the BLAS for vectors.
template <int width>
using Rows = Eigen::Map<
    Eigen::Matrix<double, width, Eigen::Dynamic, width == 1 ? Eigen::RowMajor : Eigen::ColMajor>>;
using Values = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;

/// One supernode and the part of x^T that belongs to its own columns.
template <int width>
struct Supernode {
    Values triangle;   ///< [columns, columns], lower
    Values rectangle;  ///< [rows below, columns]
    const int* row_below;
    Rows<width> x;  ///< [width, columns]
};

template <int width>
class Solve {
public:
    /// x [num_columns, n]; num_columns == width where that is known.
    Solve(const SupernodalFactor& factor, Index num_columns, double* x)
        : factor_(factor), num_columns_(num_columns), x_(x) {
        int most_rows = 0;
        for (Index s = 0; s < factor.num_blocks; ++s)
            most_rows = std::max(most_rows, factor.first_row[s + 1] - factor.first_row[s]);
        below_.resize(static_cast<std::size_t>(most_rows) * num_columns);
    }

    /// x := L^-1 x
    void down() {
        for (Index s = 0; s < factor_.num_blocks; ++s) {
            Supernode<width> node = supernode(s);
            if (node.x.isZero(0)) continue;
            node.triangle.transpose()
                .template triangularView<Eigen::Upper>()
                .template solveInPlace<Eigen::OnTheRight>(node.x);
            Rows<width> below(below_.data(), num_columns_, node.rectangle.rows());
            below.noalias() = node.x * node.rectangle.transpose();
            for (Eigen::Index i = 0; i < below.cols(); ++i) {
                double* to = row(node.row_below[i]);
                const double* from = below.col(i).data();
                for (Index c = 0; c < num_columns_; ++c) to[c] -= from[c];
            }
        }
    }

    /// x := L^-T x
    void up() {
        for (Index s = factor_.num_blocks - 1; s >= 0; --s) {
            Supernode<width> node = supernode(s);
            Rows<width> below(below_.data(), num_columns_, node.rectangle.rows());
            for (Eigen::Index i = 0; i < below.cols(); ++i)
                std::copy_n(row(node.row_below[i]), num_columns_, below.col(i).data());
            node.x.noalias() -= below * node.rectangle;
            node.triangle.template triangularView<Eigen::Lower>()
                .template solveInPlace<Eigen::OnTheRight>(node.x);
        }
    }

private:
    double* row(int r) { return x_ + static_cast<std::ptrdiff_t>(r) * num_columns_; }

    Supernode<width> supernode(Index s) {
        const int first = factor_.first_column[s];
        const int columns = factor_.first_column[s + 1] - first;
        const int rows = factor_.first_row[s + 1] - factor_.first_row[s];
        const double* value = factor_.value + factor_.first_value[s];
        return {Values(value, columns, columns, Eigen::OuterStride<>(rows)),
                Values(value + columns, rows - columns, columns, Eigen::OuterStride<>(rows)),
                factor_.row + factor_.first_row[s] + columns,
                Rows<width>(row(first), num_columns_, columns)};
    }

    const SupernodalFactor& factor_;
    Index num_columns_;
    double* x_;
    std::vector<double> below_;  ///< [num_columns, rows below] of the supernode at hand
};

}  // namespace

void solve_supernodal(const SupernodalFactor& factor, Index width, double* x) {
    if (width == 1) {
        Solve<1> solve(factor, 1, x);
        solve.down();
        solve.up();
    } else {
        Solve<Eigen::Dynamic> solve(factor, width, x);
        solve.down();
        solve.up();
    }
}

}  // namespace palpate

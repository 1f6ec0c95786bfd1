// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Right-hand sides in and solutions out of a factor: [rows, width], column index fastest, zero at
/// first, the first row aligned to a cache line.
class FactorBlock {
public:
    FactorBlock(Index rows, Index width)
        : width_(width),
          lines_((static_cast<std::size_t>(rows) * width + doubles_per_line - 1) /
                 doubles_per_line) {}

    Index width() const { return width_; }
    double* data() { return lines_.front().value; }
    double* row(Index r) { return data() + static_cast<std::size_t>(r) * width_; }

private:
    static constexpr std::size_t doubles_per_line = 8;
    struct alignas(64) Line {
        double value[doubles_per_line] = {};
    };
    Index width_;
    std::vector<Line> lines_;
};

/// The Cholesky factor of one sparse symmetric positive definite matrix, fp64, by some library.
class SparseFactor {
public:
    using Lower = Eigen::SparseMatrix<double>;  ///< lower triangle, rows of each column ascending

    virtual ~SparseFactor() = default;
    /// Name, version and kind: "Eigen 3.4.0 LDLT".
    virtual std::string library() const = 0;
    /// Orders the unknowns and finds the pattern of the factor. Once, before `factorise`.
    virtual void analyse(const Lower& matrix) = 0;
    /// Takes new values for the pattern that was analysed. Throws Error(solve_failed) if the matrix
    /// is not positive definite beyond rounding, Error(out_of_memory) if the factor does not fit.
    virtual void factorise(const Lower& matrix) = 0;
    /// [n] the row of a block that holds unknown i: `solve` works in the order of the factor.
    virtual const std::vector<int>& position() const = 0;
    /// How wide the blocks for `columns` right-hand sides of one thread should be: at least 1.
    virtual Index block_width(Index columns) const = 0;
    /// Whether one call of `solve` uses all cores, through BLAS, and others wait for it: batches
    /// are then better as wide as can be, and solved without a SerialBlas.
    virtual bool brings_threads() const { return false; }
    /// x := A^-1 x, from any number of threads at a time. Right-hand sides of few entries are
    /// cheap: what they do not reach on the way down the factor is skipped.
    virtual void solve(FactorBlock& x) const = 0;

protected:
    /// Throws Error(solve_failed) unless the pivots say that the matrix is definite.
    static void require_definite(bool finished, double smallest_pivot, double largest_pivot);
};

}  // namespace palpate

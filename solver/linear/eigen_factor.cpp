// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/eigen_factor.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <iterator>

#include "solver/base/multiversion.hpp"
#include "solver/linear/dissected_order.hpp"

namespace palpate {
namespace {

/// Columns that share one pass over the factor: at most two cache lines, and no more than there
/// are, since a pass costs by what it could take.
constexpr Index widths[] = {1, 4, 8, 16};

/// L in compressed columns, without its unit diagonal.
struct UnitLower {
    Index n;
    const int* offset;
    const int* row;
    const double* value;
};

/// x := L^-1 x; x [n, width]. Columns of L that meet a zero row of x are skipped.
template <Index width>
void solve_lower(const UnitLower& lower, double* x) {
    const auto& [n, offset, row, value] = lower;
    for (Index j = 0; j < n; ++j) {
        double xj[width];
        bool is_zero = true;
        for (Index c = 0; c < width; ++c) {
            xj[c] = x[static_cast<std::size_t>(j) * width + c];
            is_zero = is_zero && xj[c] == 0;
        }
        if (is_zero) continue;
        for (int p = offset[j]; p < offset[j + 1]; ++p) {
            double* xi = x + static_cast<std::size_t>(row[p]) * width;
            for (Index c = 0; c < width; ++c) xi[c] -= value[p] * xj[c];
        }
    }
}

/// x := L^-T x.
template <Index width>
void solve_lower_transposed(const UnitLower& lower, double* x) {
    const auto& [n, offset, row, value] = lower;
    for (Index j = n - 1; j >= 0; --j) {
        double xj[width];
        for (Index c = 0; c < width; ++c) xj[c] = x[static_cast<std::size_t>(j) * width + c];
        for (int p = offset[j]; p < offset[j + 1]; ++p) {
            const double* xi = x + static_cast<std::size_t>(row[p]) * width;
            for (Index c = 0; c < width; ++c) xj[c] -= value[p] * xi[c];
        }
        for (Index c = 0; c < width; ++c) x[static_cast<std::size_t>(j) * width + c] = xj[c];
    }
}

template <Index width>
void solve_width(const UnitLower& lower, const double* diagonal, double* x) {
    solve_lower<width>(lower, x);
    for (Index j = 0; j < lower.n; ++j)
        for (Index c = 0; c < width; ++c) x[static_cast<std::size_t>(j) * width + c] /= diagonal[j];
    solve_lower_transposed<width>(lower, x);
}

/// x := L^-T D^-1 L^-1 x for the diagonal D; `width` is one of `widths`.
PALPATE_MULTIVERSION PALPATE_FLATTEN void solve_all(const UnitLower& lower, const double* diagonal,
                                                    Index width, double* x) {
    if (width == 1) return solve_width<1>(lower, diagonal, x);
    if (width == 4) return solve_width<4>(lower, diagonal, x);
    if (width == 8) return solve_width<8>(lower, diagonal, x);
    solve_width<16>(lower, diagonal, x);
}

/// [n] the place of each row in an order that keeps the factor sparse.
std::vector<int> sparse_order(const SparseFactor::Lower& lower) {
    if (has_dissection()) return dissected_order(lower);
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> row_at;
    const SparseFactor::Lower both = lower.selfadjointView<Eigen::Lower>();
    Eigen::AMDOrdering<int>()(both, row_at);
    std::vector<int> place(static_cast<std::size_t>(lower.rows()));
    for (int k = 0; k < static_cast<int>(place.size()); ++k) place[row_at.indices()[k]] = k;
    return place;
}

/// A symmetric matrix as the upper triangle of the one with its rows in another order; that is what
/// Eigen takes without a copy.
class ReorderedUpper {
public:
    ReorderedUpper() = default;
    /// `place`: [n] that of each row
    ReorderedUpper(const SparseFactor::Lower& lower, const std::vector<int>& place)
        : upper_(lower.rows(), lower.cols()), entries_(static_cast<std::size_t>(lower.nonZeros())) {
        std::vector<Eigen::Triplet<int>> from;  // the entry of `lower` that stands there
        from.reserve(entries_.size());
        int entry = 0;
        for (int c = 0; c < lower.outerSize(); ++c)
            for (SparseFactor::Lower::InnerIterator it(lower, c); it; ++it) {
                const auto [row, column] = std::minmax(place[it.row()], place[c]);
                from.emplace_back(row, column, entry++);
            }
        Eigen::SparseMatrix<int> sorted(lower.rows(), lower.cols());
        sorted.setFromTriplets(from.begin(), from.end());
        upper_ = sorted.cast<double>();
        std::copy_n(sorted.valuePtr(), entries_.size(), entries_.begin());
    }

    /// Of the pattern that this was made of.
    const Eigen::SparseMatrix<double>& fill(const SparseFactor::Lower& lower) {
        for (std::size_t k = 0; k < entries_.size(); ++k)
            upper_.valuePtr()[k] = lower.valuePtr()[entries_[k]];
        return upper_;
    }

private:
    Eigen::SparseMatrix<double> upper_;
    std::vector<int> entries_;  ///< [entries] of the lower triangle
};

class EigenFactor final : public SparseFactor {
public:
    std::string library() const override {
        return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
               std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION) +
               " LDLT";
    }

    void analyse(const Lower& matrix) override {
        position_ = sparse_order(matrix);
        upper_ = ReorderedUpper(matrix, position_);
        factor_.analyzePattern(upper_.fill(matrix));
    }

    void factorise(const Lower& matrix) override {
        factor_.factorize(upper_.fill(matrix));
        diagonal_ = factor_.vectorD();
        require_definite(factor_.info() == Eigen::Success, diagonal_.minCoeff(),
                         diagonal_.maxCoeff());
    }

    const std::vector<int>& position() const override { return position_; }
    Index block_width(Index columns) const override {
        for (const Index width : widths)
            if (columns <= width) return width;
        return widths[std::size(widths) - 1];
    }

    void solve(FactorBlock& x) const override {
        const auto& l = factor_.matrixL().nestedExpression();
        const UnitLower lower{static_cast<Index>(position_.size()), l.outerIndexPtr(),
                              l.innerIndexPtr(), l.valuePtr()};
        solve_all(lower, diagonal_.data(), x.width(), x.data());
    }

private:
    ReorderedUpper upper_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Upper, Eigen::NaturalOrdering<int>>
        factor_;
    Eigen::VectorXd diagonal_;
    std::vector<int> position_;
};

}  // namespace

std::unique_ptr<SparseFactor> make_eigen_factor() { return std::make_unique<EigenFactor>(); }

}  // namespace palpate

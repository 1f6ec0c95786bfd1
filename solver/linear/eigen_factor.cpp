// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/eigen_factor.hpp"

#include <Eigen/SparseCholesky>

#include "solver/base/multiversion.hpp"

namespace palpate {
namespace {

constexpr Index pass_width = 16;  ///< columns that share one pass over the factor: two cache lines

/// x := L^-1 x for the unit lower triangle L in compressed columns; x [n, pass_width]. Columns of L
/// that meet a zero row of x are skipped.
PALPATE_MULTIVERSION
void solve_lower(Index n, const int* offset, const int* row, const double* value, double* x) {
    for (Index j = 0; j < n; ++j) {
        double xj[pass_width];
        bool is_zero = true;
        for (Index c = 0; c < pass_width; ++c) {
            xj[c] = x[static_cast<std::size_t>(j) * pass_width + c];
            is_zero = is_zero && xj[c] == 0;
        }
        if (is_zero) continue;
        for (int p = offset[j]; p < offset[j + 1]; ++p) {
            double* xi = x + static_cast<std::size_t>(row[p]) * pass_width;
            for (Index c = 0; c < pass_width; ++c) xi[c] -= value[p] * xj[c];
        }
    }
}

/// x := L^-T x.
PALPATE_MULTIVERSION
void solve_lower_transposed(Index n, const int* offset, const int* row, const double* value,
                            double* x) {
    for (Index j = n - 1; j >= 0; --j) {
        double xj[pass_width];
        for (Index c = 0; c < pass_width; ++c)
            xj[c] = x[static_cast<std::size_t>(j) * pass_width + c];
        for (int p = offset[j]; p < offset[j + 1]; ++p) {
            const double* xi = x + static_cast<std::size_t>(row[p]) * pass_width;
            for (Index c = 0; c < pass_width; ++c) xj[c] -= value[p] * xi[c];
        }
        for (Index c = 0; c < pass_width; ++c)
            x[static_cast<std::size_t>(j) * pass_width + c] = xj[c];
    }
}

class EigenFactor final : public SparseFactor {
public:
    std::string library() const override {
        return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
               std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION) +
               " LDLT";
    }

    void analyse(const Lower& matrix) override {
        factor_.analyzePattern(matrix);
        const auto& order = factor_.permutationP().indices();
        position_.assign(order.begin(), order.end());
    }

    void factorise(const Lower& matrix) override {
        factor_.factorize(matrix);
        const auto pivots = factor_.vectorD();
        require_definite(factor_.info() == Eigen::Success, pivots.minCoeff(), pivots.maxCoeff());
    }

    const std::vector<int>& position() const override { return position_; }
    Index block_width(Index) const override { return pass_width; }

    void solve(FactorBlock& x) const override {
        const auto& lower = factor_.matrixL().nestedExpression();
        const Index n = static_cast<Index>(position_.size());
        solve_lower(n, lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr(), x.data());
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, pass_width, Eigen::RowMajor>>(x.data(), n,
                                                                                       pass_width)
            .array()
            .colwise() /= factor_.vectorD().array();
        solve_lower_transposed(n, lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr(),
                               x.data());
    }

private:
    Eigen::SimplicialLDLT<Lower, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
    std::vector<int> position_;
};

}  // namespace

std::unique_ptr<SparseFactor> make_eigen_factor() { return std::make_unique<EigenFactor>(); }

}  // namespace palpate

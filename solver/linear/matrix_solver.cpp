// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/matrix_solver.hpp"

#include <algorithm>

#include "solver/base/error.hpp"
#include "solver/linear/factor_libraries.hpp"
#include "solver/linear/free_dofs.hpp"

namespace palpate {
namespace {

/// Where factorising begins to take longer than conjugate gradients, measured through PoCL on two
/// cores (docs/performance.md).
constexpr Index most_direct_dofs = 3000;

class FactorSolver final : public MatrixSolver {
public:
    FactorSolver(const MatrixSolverMesh& mesh, const MatrixSolverOptions& options)
        : free_(number_free_dofs(mesh.graph, mesh.prescribed)),
          factor_(make_sparse_factor(options.direct_library)) {}

    bool set(const BlockMatrix& matrix, double shift) override {
        is_indefinite_ = false;
        if (free_.count == 0) return true;
        SparseFactor::Lower lower = free_lower(matrix, free_);
        if (shift > 0) {
            const double size = lower.diagonal().cwiseAbs().mean();
            for (Index k = 0; k < free_.count; ++k) lower.coeffRef(k, k) += shift * size;
        }
        if (!is_analysed_) factor_->analyse(lower);
        is_analysed_ = true;
        try {
            factor_->factorise(lower);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::solve_failed) throw;
            failure_ = error.what();
            is_indefinite_ = true;
            return false;
        }
        return true;
    }

    bool solve(const Eigen::MatrixXd& right, Eigen::Ref<Eigen::MatrixXd> x) override {
        const auto columns = static_cast<Index>(right.cols());
        const Index width = factor_->block_width(columns);
        const std::vector<int>& position = factor_->position();
        for (Index first = 0; first < columns && free_.count > 0; first += width) {
            const Index count = std::min(width, columns - first);
            FactorBlock block(free_.count, width);
            for (Eigen::Index d = 0; d < right.rows(); ++d)
                if (free_.number[d] >= 0)
                    for (Index c = 0; c < count; ++c)
                        block.row(position[free_.number[d]])[c] = right(d, first + c);
            factor_->solve(block);
            for (Eigen::Index d = 0; d < right.rows(); ++d)
                if (free_.number[d] >= 0)
                    for (Index c = 0; c < count; ++c)
                        x(d, first + c) = block.row(position[free_.number[d]])[c];
        }
        return true;
    }

    bool is_indefinite() const override { return is_indefinite_; }
    const std::string& failure() const override { return failure_; }

private:
    FreeDofs free_;
    std::unique_ptr<SparseFactor> factor_;
    bool is_analysed_ = false;
    bool is_indefinite_ = false;
    std::string failure_;
};

}  // namespace

std::unique_ptr<MatrixSolver> make_factor_solver(const MatrixSolverMesh& mesh,
                                                 const MatrixSolverOptions& options) {
    return std::make_unique<FactorSolver>(mesh, options);
}

std::unique_ptr<MatrixSolver> make_matrix_solver(const MatrixSolverMesh& mesh,
                                                 const MatrixSolverOptions& options) {
    MatrixSolverOptions chosen = options;
    if (chosen.method == LinearMethod::automatic)
        chosen.method = mesh.prescribed.size() > most_direct_dofs ? LinearMethod::multigrid
                                                                  : LinearMethod::direct;
    if (chosen.method == LinearMethod::direct) return make_factor_solver(mesh, chosen);
    return make_gradient_solver(mesh, chosen);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include "bench/peers/peers.hpp"
#include "solver/base/error.hpp"

namespace palpate::bench {
namespace {

using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor, Index>;

/// Conjugate gradients with the diagonal as preconditioner, column by column. Both triangles and
/// row-major order: the form whose product Eigen shares out among OpenMP threads.
class EigenCg final : public Peer {
public:
    /// `threads` 0: as many as OpenMP wants.
    explicit EigenCg(int threads) : threads_(threads) {}

    void set_up(const FreeMatrix& matrix) override {
        const Eigen::Map<const Rows> rows(
            matrix.num_rows(), matrix.num_rows(), static_cast<Eigen::Index>(matrix.values.size()),
            matrix.offsets.data(), matrix.columns.data(), matrix.values.data());
        rows_ = rows;
        solver_.compute(rows_);
        solver_.setMaxIterations(20000);
    }

    int solve(const Columns& b, Columns& x, double rtol) override {
        Eigen::setNbThreads(threads_);
        solver_.setTolerance(rtol);
        x.resize(b.rows(), b.cols());
        int iterations = 0;
        for (Index c = 0; c < b.cols(); ++c) {
            const Eigen::VectorXd column = b.col(c);
            x.col(c) = solver_.solve(column);
            if (solver_.info() != Eigen::Success)
                throw Error(ErrorCode::solve_failed,
                            "Eigen's conjugate gradients did not converge "
                            "in 20,000 iterations.");
            iterations += static_cast<int>(solver_.iterations());
        }
        return iterations;
    }

    std::string describe() const override {
        Eigen::setNbThreads(threads_);
        return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
               std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION) +
               ", " + std::to_string(Eigen::nbThreads()) + " thread(s)";
    }

private:
    int threads_;
    Rows rows_;
    Eigen::ConjugateGradient<Rows, Eigen::Lower | Eigen::Upper> solver_;
};

}  // namespace

std::vector<PeerEntry> eigen_peers() {
    // Threads that wait actively lose much on a machine that is not theirs alone: one thread stands
    // beside them.
    return {{"eigen_cg_jacobi", [] { return std::make_unique<EigenCg>(1); }},
            {"eigen_cg_jacobi_threads", [] { return std::make_unique<EigenCg>(0); }}};
}

}  // namespace palpate::bench

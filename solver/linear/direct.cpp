// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/direct.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <atomic>
#include <chrono>
#include <mutex>

#include "solver/base/error.hpp"
#include "solver/base/multiversion.hpp"
#include "solver/base/parallel.hpp"
#include "solver/linear/constrained_system.hpp"

namespace palpate {
namespace {

constexpr Index batch_width = 16;  ///< columns that share one pass over the factor: two cache lines
constexpr double smallest_pivot_ratio = 1e-14;  ///< below: a mechanism, not a stiff structure
constexpr int max_refinement_steps = 2;

using Sparse = Eigen::SparseMatrix<double>;
using Batch = Eigen::Matrix<double, Eigen::Dynamic, batch_width, Eigen::RowMajor>;

/// x := L^-1 x for the unit lower triangle L in compressed columns; x [n, batch_width]. Columns of
/// L that meet a zero row of x are skipped: right-hand sides of few entries stay cheap.
PALPATE_MULTIVERSION
void solve_lower(Index n, const int* offset, const int* row, const double* value, double* x) {
    for (Index j = 0; j < n; ++j) {
        double xj[batch_width];
        bool is_zero = true;
        for (Index c = 0; c < batch_width; ++c) {
            xj[c] = x[static_cast<std::size_t>(j) * batch_width + c];
            is_zero = is_zero && xj[c] == 0;
        }
        if (is_zero) continue;
        for (int p = offset[j]; p < offset[j + 1]; ++p) {
            double* xi = x + static_cast<std::size_t>(row[p]) * batch_width;
            for (Index c = 0; c < batch_width; ++c) xi[c] -= value[p] * xj[c];
        }
    }
}

/// x := L^-T x.
PALPATE_MULTIVERSION
void solve_lower_transposed(Index n, const int* offset, const int* row, const double* value,
                            double* x) {
    for (Index j = n - 1; j >= 0; --j) {
        double xj[batch_width];
        for (Index c = 0; c < batch_width; ++c)
            xj[c] = x[static_cast<std::size_t>(j) * batch_width + c];
        for (int p = offset[j]; p < offset[j + 1]; ++p) {
            const double* xi = x + static_cast<std::size_t>(row[p]) * batch_width;
            for (Index c = 0; c < batch_width; ++c) xj[c] -= value[p] * xi[c];
        }
        for (Index c = 0; c < batch_width; ++c)
            x[static_cast<std::size_t>(j) * batch_width + c] = xj[c];
    }
}

/// Nodes of no tetrahedron have no stiffness and stay where they are.
std::vector<Index> number_free_dofs(const ConstrainedSystem& system, Index& num_free) {
    const Adjacency& graph = system.stiffness().graph;
    std::vector<Index> number(system.model().num_dofs(), -1);
    num_free = 0;
    for (Index d = 0; d < system.model().num_dofs(); ++d) {
        const bool has_tets = graph.offsets[d / 3 + 1] - graph.offsets[d / 3] > 1;
        if (has_tets && !system.is_prescribed(d)) number[d] = num_free++;
    }
    return number;
}

/// The lower triangle of K on the free dofs; K is symmetric, so its columns are read off as rows.
Sparse free_stiffness(const StiffnessMatrix& stiffness, const std::vector<Index>& number,
                      Index num_free) {
    Sparse lower(num_free, num_free);
    lower.reserve(static_cast<Eigen::Index>(stiffness.blocks.size()) / 2 + num_free);
    const Adjacency& graph = stiffness.graph;
    for (Index d = 0; d < static_cast<Index>(number.size()); ++d) {
        if (number[d] < 0) continue;
        lower.startVec(number[d]);
        for (Index k = graph.offsets[d / 3]; k < graph.offsets[d / 3 + 1]; ++k)
            for (Index i = 0; i < 3; ++i) {
                const Index other = number[3 * graph.items[k] + i];
                if (other >= number[d])
                    lower.insertBack(other, number[d]) =
                        stiffness.blocks[9 * static_cast<std::size_t>(k) + 3 * (d % 3) + i];
            }
    }
    lower.finalize();
    return lower;
}

class DirectSolver final : public LinearSolver {
public:
    DirectSolver(const Model& model, const LinearSolverOptions& options, std::string reason)
        : options_(options),
          reason_(std::move(reason)),
          system_(model),
          number_(number_free_dofs(system_, num_free_)) {
        factorise();
    }

    LinearSolverInfo describe() const override {
        BackendInfo host;
        host.backend = "reference";
        host.device = "host";
        host.compute_units = num_host_threads();
        host.version = "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
                       std::to_string(EIGEN_MAJOR_VERSION) + "." +
                       std::to_string(EIGEN_MINOR_VERSION);
        return {host, LinearMethod::direct, host.version + " LDLT", reason_};
    }

    void set_stiffness(std::span<const double> stiffness_kpa) override {
        system_.set_stiffness(stiffness_kpa);
        factorise();
    }

    LinearSolverSummary solve(const Columns& b, Columns& x, const ProgressSink& progress) override {
        const auto start = std::chrono::steady_clock::now();
        if (b.rows() != system_.model().num_dofs())
            throw Error(ErrorCode::invalid_argument,
                        "The right-hand side of a linear solve has " + std::to_string(b.rows()) +
                            " rows, the model has " + std::to_string(system_.model().num_dofs()) +
                            " degrees of freedom.");
        x.resize(b.rows(), b.cols());
        const Index columns = static_cast<Index>(b.cols());
        const Index batches = (columns + batch_width - 1) / batch_width;
        LinearSolverSummary summary;
        std::mutex merge;
        std::atomic<Index> next{0};
        parallel_ranges(batches, 1, [&](Index, Index) {
            for (Index batch = next++; batch < batches; batch = next++) {
                const Index first = batch * batch_width;
                const LinearSolverSummary part =
                    solve_batch(b, x, first, std::min(batch_width, columns - first));
                const std::lock_guard lock(merge);
                summary.relative_residual =
                    std::max(summary.relative_residual, part.relative_residual);
                summary.refinements = std::max(summary.refinements, part.refinements);
            }
        });
        report_progress(progress, "solving", 1);
        finish(summary, start);
        return summary;
    }

private:
    void factorise() {
        if (num_free_ == 0) return;
        const Sparse lower = free_stiffness(system_.stiffness(), number_, num_free_);
        if (!analysed_) factor_.analyzePattern(lower);
        analysed_ = true;
        factor_.factorize(lower);
        const auto pivots = factor_.vectorD();
        if (factor_.info() != Eigen::Success ||
            !(pivots.minCoeff() > smallest_pivot_ratio * pivots.maxCoeff()))
            throw Error(ErrorCode::solve_failed,
                        "The stiffness matrix is singular: a part of the mesh is free to move "
                        "rigidly; prescribe the displacement of at least three of its nodes.");
    }

    LinearSolverSummary solve_batch(const Columns& b, Columns& x, Index first, Index width) const {
        const Columns part = b.middleCols(first, width);
        Columns u = part;
        for (Index d = 0; d < u.rows(); ++d)
            if (!system_.is_prescribed(d)) u.row(d).setZero();
        Columns r;
        system_.residual(part, u, r);
        const std::vector<double> scale = finite_norms(r, "right-hand side");

        LinearSolverSummary summary;
        for (int step = 0; step < 1 + max_refinement_steps; ++step) {
            add_correction(r, u);
            system_.residual(part, u, r);
            summary.relative_residual = largest_ratio(finite_norms(r, "residual"), scale);
            summary.refinements = step;
            if (summary.relative_residual <= options_.relative_tolerance) break;
        }
        x.middleCols(first, width) = u;
        return summary;
    }

    /// u_f += K_ff^-1 r_f
    void add_correction(const Columns& r, Columns& u) const {
        if (num_free_ == 0) return;
        const auto& position = factor_.permutationP().indices();
        Batch y = Batch::Zero(num_free_, batch_width);
        for (Index d = 0; d < r.rows(); ++d)
            if (number_[d] >= 0) y.row(position[number_[d]]).head(r.cols()) = r.row(d);

        const auto& lower = factor_.matrixL().nestedExpression();
        solve_lower(num_free_, lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr(),
                    y.data());
        y.array().colwise() /= factor_.vectorD().array();
        solve_lower_transposed(num_free_, lower.outerIndexPtr(), lower.innerIndexPtr(),
                               lower.valuePtr(), y.data());

        for (Index d = 0; d < r.rows(); ++d)
            if (number_[d] >= 0) u.row(d) += y.row(position[number_[d]]).head(r.cols());
    }

    static double largest_ratio(const std::vector<double>& norms,
                                const std::vector<double>& scale) {
        double largest = 0;
        for (std::size_t c = 0; c < norms.size(); ++c)
            if (scale[c] > 0) largest = std::max(largest, norms[c] / scale[c]);
        return largest;
    }

    void finish(LinearSolverSummary& summary, std::chrono::steady_clock::time_point start) const {
        summary.converged = summary.relative_residual <= options_.relative_tolerance;
        summary.message = summary.converged ? "solved directly"
                                            : "the direct solution misses the tolerance: the "
                                              "stiffness matrix is nearly singular";
        summary.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    LinearSolverOptions options_;
    std::string reason_;
    ConstrainedSystem system_;
    Index num_free_ = 0;
    std::vector<Index> number_;  ///< [num_dofs], number among the free dofs, or -1
    Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
    bool analysed_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> make_direct_solver(const Model& model,
                                                 const LinearSolverOptions& options,
                                                 std::string reason) {
    return std::make_unique<DirectSolver>(model, options, std::move(reason));
}

}  // namespace palpate

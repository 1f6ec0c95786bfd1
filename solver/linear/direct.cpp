// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/direct.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"
#include "solver/linear/constrained_system.hpp"
#include "solver/linear/free_dofs.hpp"
#include "solver/linear/sparse_factor.hpp"

namespace palpate {
namespace {

constexpr int max_refinement_steps = 2;

class DirectSolver final : public LinearSolver {
public:
    DirectSolver(const Model& model, const LinearSolverOptions& options, std::string reason)
        : options_(options),
          reason_(std::move(reason)),
          system_(model),
          free_(number_free_dofs(system_.stiffness().graph, system_.model().prescribed)),
          factor_(make_sparse_factor(options.direct_library)) {
        factorise();
    }

    LinearSolverInfo describe() const override {
        BackendInfo host;
        host.backend = "reference";
        host.device = "host";
        host.compute_units = num_host_threads();
        host.version = factor_->library();
        return {host, LinearMethod::direct, factor_->library(), reason_};
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
        const Index per_thread = (columns + num_host_threads() - 1) / num_host_threads();
        const Index width = factor_->block_width(per_thread);
        const Index batches = (columns + width - 1) / width;
        LinearSolverSummary summary;
        std::mutex merge;
        std::atomic<Index> next{0};
        const SerialBlas serial;
        parallel_ranges(batches, 1, [&](Index, Index) {
            for (Index batch = next++; batch < batches; batch = next++) {
                const Index first = batch * width;
                const LinearSolverSummary part =
                    solve_batch(b, x, first, std::min(width, columns - first));
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
        if (free_.count == 0) return;
        const SparseFactor::Lower lower = free_lower(system_.stiffness(), free_);
        if (!analysed_) factor_->analyse(lower);
        analysed_ = true;
        factor_->factorise(lower);
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
        if (free_.count == 0) return;
        const std::vector<int>& position = factor_->position();
        FactorBlock y(free_.count, factor_->block_width(static_cast<Index>(r.cols())));
        for (Index d = 0; d < r.rows(); ++d)
            if (free_.number[d] >= 0)
                std::copy_n(r.row(d).data(), r.cols(), y.row(position[free_.number[d]]));
        factor_->solve(y);
        for (Index d = 0; d < r.rows(); ++d)
            if (free_.number[d] >= 0)
                u.row(d) += Eigen::Map<const Eigen::RowVectorXd>(y.row(position[free_.number[d]]),
                                                                 r.cols());
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
    FreeDofs free_;
    std::unique_ptr<SparseFactor> factor_;
    bool analysed_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> make_direct_solver(const Model& model,
                                                 const LinearSolverOptions& options,
                                                 std::string reason) {
    return std::make_unique<DirectSolver>(model, options, std::move(reason));
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/direct_columns.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"
#include "solver/linear/factor_libraries.hpp"
#include "solver/linear/free_lower.hpp"

namespace palpate {
namespace {

constexpr int max_refinement_steps = 2;

double largest_ratio(const std::vector<double>& norms, const std::vector<double>& scale) {
    double largest = 0;
    for (std::size_t c = 0; c < norms.size(); ++c)
        if (scale[c] > 0) largest = std::max(largest, norms[c] / scale[c]);
    return largest;
}

void finish(LinearSolverSummary& summary, double tolerance,
            std::chrono::steady_clock::time_point start) {
    summary.converged = summary.relative_residual <= tolerance;
    summary.message = summary.converged ? "solved directly"
                                        : "the direct solution misses the tolerance: the "
                                          "stiffness matrix is nearly singular";
    summary.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

DirectColumns::DirectColumns(const ConstrainedMatrix& system, const LinearSolverOptions& options)
    : system_(system),
      options_(options),
      free_(number_free_dofs(system.stiffness().graph, system.prescribed())),
      factor_(make_sparse_factor(options.direct_library)) {
    factorise();
}

void DirectColumns::factorise() {
    if (free_.count == 0) return;
    FreeLower lower_triangle(system_.stiffness().graph, free_);
    const SparseFactor::Lower& lower = lower_triangle.fill(system_.stiffness());
    if (!analysed_) factor_->analyse(lower);
    analysed_ = true;
    factor_->factorise(lower);
}

LinearSolverSummary DirectColumns::solve(const Columns& b, Columns& x,
                                         const ProgressSink& progress) const {
    const auto start = std::chrono::steady_clock::now();
    if (b.rows() != system_.num_dofs())
        throw Error(ErrorCode::invalid_argument,
                    "The right-hand side of a linear solve has " + std::to_string(b.rows()) +
                        " rows, the model has " + std::to_string(system_.num_dofs()) +
                        " degrees of freedom.");
    x.resize(b.rows(), b.cols());
    const Index columns = static_cast<Index>(b.cols());
    // While one batch is in a factor that brings its threads, the residuals of others are computed.
    const Index solving = factor_->brings_threads() ? 1 : num_host_threads();
    const Index width = factor_->block_width((columns + solving - 1) / solving);
    const Index batches = (columns + width - 1) / width;
    LinearSolverSummary summary;
    std::mutex merge;
    std::atomic<Index> next{0};
    std::optional<SerialBlas> serial;
    if (solving > 1) serial.emplace();
    parallel_ranges(batches, 1, [&](Index, Index) {
        for (Index batch = next++; batch < batches; batch = next++) {
            const Index first = batch * width;
            const LinearSolverSummary part =
                solve_batch(b, x, first, std::min(width, columns - first));
            const std::lock_guard lock(merge);
            summary.relative_residual = std::max(summary.relative_residual, part.relative_residual);
            summary.refinements = std::max(summary.refinements, part.refinements);
        }
    });
    report_progress(progress, "solving", 1);
    finish(summary, options_.relative_tolerance, start);
    return summary;
}

LinearSolverSummary DirectColumns::solve_batch(const Columns& b, Columns& x, Index first,
                                               Index width) const {
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
void DirectColumns::add_correction(const Columns& r, Columns& u) const {
    if (free_.count == 0) return;
    const std::vector<int>& position = factor_->position();
    FactorBlock y(free_.count, factor_->block_width(static_cast<Index>(r.cols())));
    for (Index d = 0; d < r.rows(); ++d)
        if (free_.number[d] >= 0)
            std::copy_n(r.row(d).data(), r.cols(), y.row(position[free_.number[d]]));
    factor_->solve(y);
    for (Index d = 0; d < r.rows(); ++d)
        if (free_.number[d] >= 0)
            u.row(d) +=
                Eigen::Map<const Eigen::RowVectorXd>(y.row(position[free_.number[d]]), r.cols());
}

LinearSolverInfo DirectColumns::describe(const std::string& reason) const {
    return host_factor_info(factor_->library(), reason);
}

}  // namespace palpate

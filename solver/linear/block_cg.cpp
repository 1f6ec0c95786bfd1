// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/block_cg.hpp"

#include <chrono>
#include <cmath>

#include "solver/base/error.hpp"
#include "solver/linear/constrained_system.hpp"

namespace palpate {
namespace {

constexpr int check_interval =
    5;  ///< iterations between two looks at |r|: each costs a dot product

/// What one device solve is asked for at most, relative to its right-hand side. In fp32 the
/// recursive residual means little below 1e-5; what is missing costs one more refinement.
double inner_tolerance(Precision precision) {
    return precision == Precision::single ? 1e-5 : 1e-13;
}

void require_finite(std::span<const double> values) {
    for (double value : values)
        if (!std::isfinite(value))
            throw Error(ErrorCode::solve_failed,
                        "Conjugate gradients met a value that is not a finite number; try "
                        "double precision, or check the mesh for flat elements.");
}

std::span<const double> as_span(const Columns& c) {
    return {c.data(), static_cast<std::size_t>(c.size())};
}
std::span<double> as_span(Columns& c) { return {c.data(), static_cast<std::size_t>(c.size())}; }

}  // namespace

BlockCg::BlockCg(Backend& backend, Index rows, Index columns)
    : backend_(backend),
      r_(backend.make_vector(rows, columns)),
      z_(backend.make_vector(rows, columns)),
      p_(backend.make_vector(rows, columns)),
      q_(backend.make_vector(rows, columns)),
      x_(backend.make_vector(rows, columns)) {}

int BlockCg::solve(const Columns& r, std::span<const double> target, int max_iterations,
                   Columns& dx) {
    const std::size_t columns = target.size();
    const std::vector<double> one(columns, 1.0), zero(columns, 0.0);
    std::vector<double> alpha(columns), minus_alpha(columns), beta(columns);
    std::vector<double> rz(columns), rz_new(columns), pq(columns), rr(columns);
    std::vector<unsigned char> active(columns, 1);
    const auto drop_converged = [&] {
        backend_.dot(*r_, *r_, rr);
        require_finite(rr);
        bool any = false;
        for (std::size_t c = 0; c < columns; ++c) {
            active[c] = active[c] && rr[c] > target[c] * target[c];
            any = any || active[c];
        }
        return any;
    };

    backend_.copy_in(as_span(r), *r_);
    backend_.fill(*x_, 0);
    int iteration = 0;
    if (drop_converged()) {
        backend_.apply_block_jacobi(*r_, *z_);
        backend_.axpby(one, *z_, zero, *p_);
        backend_.dot(*r_, *z_, rz);
        while (iteration < max_iterations) {
            backend_.apply_stiffness(*p_, *q_);
            backend_.dot(*p_, *q_, pq);
            require_finite(pq);
            for (std::size_t c = 0; c < columns; ++c) {
                active[c] = active[c] && pq[c] > 0;
                alpha[c] = active[c] ? rz[c] / pq[c] : 0;
                minus_alpha[c] = -alpha[c];
            }
            backend_.axpby(alpha, *p_, one, *x_);
            backend_.axpby(minus_alpha, *q_, one, *r_);
            ++iteration;
            if (iteration % check_interval == 0 && !drop_converged()) break;

            backend_.apply_block_jacobi(*r_, *z_);
            backend_.dot(*r_, *z_, rz_new);
            for (std::size_t c = 0; c < columns; ++c)
                beta[c] = active[c] && rz[c] > 0 ? rz_new[c] / rz[c] : 0;
            backend_.axpby(one, *z_, beta, *p_);
            std::swap(rz, rz_new);
        }
    }
    dx.resize(r.rows(), r.cols());
    backend_.copy_out(*x_, as_span(dx));
    return iteration;
}

namespace {

class BlockCgSolver final : public LinearSolver {
public:
    BlockCgSolver(const Model& model, std::unique_ptr<Backend> backend,
                  const LinearSolverOptions& options, std::string reason)
        : options_(options),
          reason_(std::move(reason)),
          system_(model),
          backend_(std::move(backend)) {
        backend_->prepare(system_.model());
    }

    LinearSolverInfo describe() const override {
        return {backend_->describe(), LinearMethod::jacobi, "", reason_};
    }

    void set_stiffness(std::span<const double> stiffness_kpa) override {
        system_.set_stiffness(stiffness_kpa);
        backend_->set_stiffness(stiffness_kpa);
    }

    LinearSolverSummary solve(const Columns& b, Columns& x, const ProgressSink& progress) override;

private:
    LinearSolverSummary solve_batch(const Columns& b, Columns& x);
    std::vector<double> rhs_norms(const Columns& b, const Columns& x, const Columns& r) const;
    void refine(const Columns& r, const std::vector<double>& norm,
                const std::vector<double>& wanted, double floor, Columns& x,
                LinearSolverSummary& summary);

    LinearSolverOptions options_;
    std::string reason_;
    ConstrainedSystem system_;
    std::unique_ptr<Backend> backend_;
    std::unique_ptr<BlockCg> cg_;
    Index cg_columns_ = 0;
};

LinearSolverSummary BlockCgSolver::solve(const Columns& b, Columns& x,
                                         const ProgressSink& progress) {
    const auto start = std::chrono::steady_clock::now();
    const Index rows = system_.model().num_dofs();
    const bool has_guess = x.rows() > 0;
    if (b.rows() != rows || (has_guess && (x.rows() != rows || x.cols() != b.cols())))
        throw Error(ErrorCode::invalid_argument,
                    "A linear solve got " + std::to_string(b.rows()) + " rows and a guess of " +
                        std::to_string(x.rows()) + " x " + std::to_string(x.cols()) +
                        "; the model has " + std::to_string(rows) + " degrees of freedom.");
    if (!has_guess) x.setZero(b.rows(), b.cols());

    const Index columns = static_cast<Index>(b.cols());
    const Index width =
        std::clamp<Index>(columns, 1, std::max<Index>(options_.columns_per_batch, 1));
    if (cg_columns_ != width) {
        cg_.reset();
        cg_ = std::make_unique<BlockCg>(*backend_, rows, width);
        cg_columns_ = width;
    }
    LinearSolverSummary summary;
    for (Index first = 0; first < columns; first += width) {
        // The last batch is filled up with zero columns, which cost no iterations.
        const Index used = std::min(width, columns - first);
        Columns b_batch = Columns::Zero(rows, width);
        Columns x_batch = Columns::Zero(rows, width);
        b_batch.leftCols(used) = b.middleCols(first, used);
        x_batch.leftCols(used) = x.middleCols(first, used);
        const LinearSolverSummary part = solve_batch(b_batch, x_batch);
        x.middleCols(first, used) = x_batch.leftCols(used);
        summary.iterations += part.iterations;
        summary.refinements = std::max(summary.refinements, part.refinements);
        summary.relative_residual = std::max(summary.relative_residual, part.relative_residual);
        report_progress(progress, "solving", static_cast<double>(first + used) / columns);
    }
    summary.converged = summary.relative_residual <= options_.relative_tolerance;
    summary.message = summary.converged
                          ? "conjugate gradients reached the tolerance"
                          : "conjugate gradients stopped above the tolerance; allow more "
                            "iterations, or use double precision or the direct solver";
    summary.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return summary;
}

/// Norms of the residual at zero free displacement: what residuals are measured against.
std::vector<double> BlockCgSolver::rhs_norms(const Columns& b, const Columns& x,
                                             const Columns& r) const {
    bool has_guess = false;
    Columns lifted = x;
    for (Index d = 0; d < lifted.rows(); ++d) {
        if (system_.is_prescribed(d)) continue;
        has_guess = has_guess || !lifted.row(d).isZero(0);
        lifted.row(d).setZero();
    }
    if (!has_guess) return finite_norms(r, "right-hand side");
    Columns rhs;
    system_.parallel_residual(b, lifted, rhs);
    return finite_norms(rhs, "right-hand side");
}

LinearSolverSummary BlockCgSolver::solve_batch(const Columns& b, Columns& x) {
    for (Index d = 0; d < x.rows(); ++d)
        if (system_.is_prescribed(d)) x.row(d) = b.row(d);
    Columns r;
    system_.parallel_residual(b, x, r);
    const std::vector<double> scale = rhs_norms(b, x, r);
    for (std::size_t c = 0; c < scale.size(); ++c) {
        if (scale[c] > 0) continue;
        for (Index d = 0; d < x.rows(); ++d)
            if (!system_.is_prescribed(d)) x(d, c) = 0;
        r.col(c).setZero();
    }

    LinearSolverSummary summary;
    double floor = inner_tolerance(backend_->describe().precision);
    std::vector<double> wanted(scale.size());
    for (std::size_t c = 0; c < scale.size(); ++c)
        wanted[c] = options_.relative_tolerance * scale[c];
    double before = 0;
    for (int step = 0;; ++step) {
        const std::vector<double> norm = finite_norms(r, "residual");
        summary.relative_residual = 0;
        for (std::size_t c = 0; c < scale.size(); ++c)
            if (scale[c] > 0)
                summary.relative_residual = std::max(summary.relative_residual, norm[c] / scale[c]);
        summary.refinements = step;
        const bool stalled = step >= 2 && summary.relative_residual > 0.5 * before;
        if (summary.relative_residual <= options_.relative_tolerance ||
            step >= options_.max_refinements || stalled)
            return summary;
        // Do not ask again for more digits than the last device solve has given.
        if (step > 0) floor = std::max(floor, 0.1 * summary.relative_residual / before);
        before = summary.relative_residual;
        refine(r, norm, wanted, std::min(floor, 0.1), x, summary);
        system_.parallel_residual(b, x, r);
    }
}

/// x += K^-1 r on the device; every column is scaled to length 1, far from under- and overflow.
void BlockCgSolver::refine(const Columns& r, const std::vector<double>& norm,
                           const std::vector<double>& wanted, double floor, Columns& x,
                           LinearSolverSummary& summary) {
    Eigen::RowVectorXd to_unit = Eigen::RowVectorXd::Zero(r.cols());
    Eigen::RowVectorXd from_unit = Eigen::RowVectorXd::Zero(r.cols());
    std::vector<double> target(norm.size(), 1.0);
    for (std::size_t c = 0; c < norm.size(); ++c) {
        if (norm[c] <= wanted[c]) continue;
        to_unit[c] = 1.0 / norm[c];
        from_unit[c] = norm[c];
        target[c] = std::max(floor, 0.5 * wanted[c] / norm[c]);
    }
    const Columns unit = r.array().rowwise() * to_unit.array();
    Columns dx;
    summary.iterations += cg_->solve(unit, target, options_.max_iterations, dx);
    for (Index d = 0; d < x.rows(); ++d)
        if (!system_.is_prescribed(d)) x.row(d).array() += dx.row(d).array() * from_unit.array();
}

}  // namespace

std::unique_ptr<LinearSolver> make_block_cg_solver(const Model& model,
                                                   std::unique_ptr<Backend> backend,
                                                   const LinearSolverOptions& options,
                                                   std::string reason) {
    return std::make_unique<BlockCgSolver>(model, std::move(backend), options, std::move(reason));
}

}  // namespace palpate

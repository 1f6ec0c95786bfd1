// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/cg_solver.hpp"

#include <chrono>
#include <optional>

#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/block_cg.hpp"
#include "solver/linear/constrained_system.hpp"
#include "solver/linear/multigrid/multigrid.hpp"
#include "solver/mesh/spatial_order.hpp"

namespace palpate {
namespace {

/// What one device solve is asked for at most, relative to its right-hand side. In fp32 the
/// recursive residual means little below 1e-5; what is missing costs one more refinement.
double inner_tolerance(Precision precision) {
    return precision == Precision::single ? 1e-5 : 1e-13;
}

class CgSolver final : public LinearSolver {
public:
    CgSolver(const Model& model, std::unique_ptr<Backend> backend,
             const LinearSolverOptions& options, MethodChoice choice)
        : options_(options),
          choice_(std::move(choice)),
          order_(spatial_order(model.mesh.nodes)),
          system_(renumbered(model, order_)),
          backend_(std::move(backend)) {
        backend_->prepare(system_.model());
        if (choice_.method == LinearMethod::multigrid)
            set_up_multigrid();
        else
            preconditioner_ = make_block_jacobi(*backend_, backend_->stiffness());
        cg_.emplace(*backend_, *preconditioner_);
    }

    LinearSolverInfo describe() const override {
        return {backend_->describe(), choice_.method, "", choice_.reason};
    }

    void set_stiffness(std::span<const double> stiffness_kpa) override {
        system_.set_stiffness(stiffness_kpa);
        backend_->set_stiffness(stiffness_kpa);
        if (single_) single_->set_stiffness(stiffness_kpa);
        if (!hierarchy_) return;
        hierarchy_->update(system_.stiffness());
        multigrid_->update(*hierarchy_);
        hierarchy_->drop_values();
    }

    LinearSolverSummary solve(const Columns& b, Columns& x, const ProgressSink& progress) override;

private:
    LinearSolverSummary solve_batch(const Columns& b, Columns& x);
    std::vector<double> rhs_norms(const Columns& b, const Columns& x, const Columns& r) const;
    void refine(const Columns& r, const std::vector<double>& norm,
                const std::vector<double>& wanted, double floor, Columns& x,
                LinearSolverSummary& summary);

    /// The hierarchy works in single precision wherever the device computes in double.
    void set_up_multigrid() {
        hierarchy_.emplace(system_.model(), system_.stiffness());
        const BackendInfo device = backend_->describe();
        const bool is_mixed =
            device.precision == Precision::double_ && device.backend != "reference";
        if (is_mixed) {
            BackendOptions single = options_.device;
            single.precision = Precision::single;
            single_ = make_backend(options_.backend, single);
            single_->prepare(system_.model());
        }
        auto multigrid = std::make_unique<Multigrid>(is_mixed ? *single_ : *backend_, *hierarchy_);
        hierarchy_->drop_values();
        multigrid_ = multigrid.get();
        preconditioner_ = is_mixed
                              ? make_precision_bridge(*backend_, *single_, std::move(multigrid))
                              : std::move(multigrid);
    }

    LinearSolverOptions options_;
    MethodChoice choice_;
    std::vector<Index> order_;  ///< [num_nodes] the caller's number of the k-th node of `system_`
    ConstrainedSystem system_;
    std::unique_ptr<Backend> backend_;
    std::unique_ptr<Backend> single_;     ///< for multigrid within double precision
    std::optional<Hierarchy> hierarchy_;  ///< multigrid only
    Multigrid* multigrid_ = nullptr;      ///< inside `preconditioner_`
    std::unique_ptr<Preconditioner> preconditioner_;
    std::optional<BlockCg> cg_;
};

LinearSolverSummary CgSolver::solve(const Columns& b, Columns& x, const ProgressSink& progress) {
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
    LinearSolverSummary summary;
    for (Index first = 0; first < columns; first += width) {
        const Index used = std::min(width, columns - first);
        Columns b_batch(rows, used), x_batch(rows, used);
        for (std::size_t k = 0; k < order_.size(); ++k) {
            b_batch.middleRows<3>(3 * k) = b.block(3 * order_[k], first, 3, used);
            x_batch.middleRows<3>(3 * k) = x.block(3 * order_[k], first, 3, used);
        }
        const LinearSolverSummary part = solve_batch(b_batch, x_batch);
        for (std::size_t k = 0; k < order_.size(); ++k)
            x.block(3 * order_[k], first, 3, used) = x_batch.middleRows<3>(3 * k);
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
std::vector<double> CgSolver::rhs_norms(const Columns& b, const Columns& x,
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

LinearSolverSummary CgSolver::solve_batch(const Columns& b, Columns& x) {
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
void CgSolver::refine(const Columns& r, const std::vector<double>& norm,
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

std::unique_ptr<LinearSolver> make_cg_solver(const Model& model, std::unique_ptr<Backend> backend,
                                             const LinearSolverOptions& options,
                                             MethodChoice choice) {
    return std::make_unique<CgSolver>(model, std::move(backend), options, std::move(choice));
}

}  // namespace palpate

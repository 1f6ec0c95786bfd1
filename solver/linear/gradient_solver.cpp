// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <mutex>
#include <optional>
#include <random>

#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/linear/block_cg.hpp"
#include "solver/linear/free_dofs.hpp"
#include "solver/linear/matrix_solver.hpp"
#include "solver/linear/multigrid/multigrid.hpp"

namespace palpate {
namespace {

constexpr Index rows_per_thread = 500;
constexpr double probe_tolerance = 1e-3;  ///< of the solve that looks for negative curvature
constexpr double worn_out = 1.5;          ///< iterations over those with a new preconditioner
constexpr int spare_iterations = 5;

/// Conjugate gradients on a device matrix that follows `set`. A multigrid hierarchy stays as long
/// as it serves: that of one load step's tangent is good for the next ones too.
class GradientSolver final : public MatrixSolver {
public:
    GradientSolver(const MatrixSolverMesh& mesh, const MatrixSolverOptions& options)
        : options_(options),
          nodes_(mesh.nodes.begin(), mesh.nodes.end()),
          free_(number_free_dofs(mesh.graph, mesh.prescribed)),
          backend_(make_backend(options.backend, options.device)) {
        for (const Index number : free_.number) held_.push_back(number < 0);
        const BackendInfo device = backend_->describe();
        // As in `make_cg_solver`, multigrid works in single precision on every device.
        if (options.method == LinearMethod::multigrid && device.backend != "reference" &&
            device.precision == Precision::double_) {
            BackendOptions single = options.device;
            single.precision = Precision::single;
            single_ = make_backend(options.backend, single);
        }
        constrained_.graph = mesh.graph;
        constrained_.num_columns = static_cast<Index>(nodes_.size());
        constrained_.blocks.resize(9 * mesh.graph.items.size());
    }

    bool set(const BlockMatrix& matrix, double shift) override {
        is_indefinite_ = false;
        if (free_.count == 0) return true;
        constrain(matrix, shift);
        try {
            if (!cg_ || options_.method == LinearMethod::jacobi) {
                renew_preconditioner();
            } else {
                backend_->set_values(*matrix_, constrained_, {});
                is_new_ = false;
                if (is_worn_out_) renew_preconditioner();
            }
        } catch (const Error& error) {
            return fails(error);
        }
        if (shift > 0) is_suspect_ = true;
        if (shift > 0 || !is_suspect_) return true;
        if (!probe()) return false;
        is_suspect_ = false;
        return true;
    }

    bool solve(const Eigen::MatrixXd& right, Eigen::Ref<Eigen::MatrixXd> x) override {
        const std::lock_guard<std::mutex> lock(mutex_);  // a device has one queue
        constexpr Eigen::Index batch = 16;
        is_indefinite_ = false;
        for (Eigen::Index first = 0; first < right.cols() && free_.count > 0; first += batch) {
            const Eigen::Index count = std::min(batch, right.cols() - first);
            if (!solve_batch(right.middleCols(first, count), x.middleCols(first, count)))
                return false;
        }
        return true;
    }

    bool is_direct() const override { return false; }
    bool is_indefinite() const override { return is_indefinite_; }
    const std::string& failure() const override { return failure_; }
    LinearSolverInfo describe() const override {
        return {backend_->describe(), options_.method, "", "asked for"};
    }

private:
    bool finds_indefinite(const std::string& failure) {
        failure_ = failure;
        is_suspect_ = is_indefinite_ = true;
        return false;
    }
    bool fails(const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw error;
        return finds_indefinite(error.what());
    }

    /// The identity at held dofs, the shift on the diagonal of the others.
    void constrain(const BlockMatrix& matrix, double shift);
    double mean_diagonal(const BlockMatrix& matrix) const;
    std::vector<double> inverse_diagonal() const;
    void renew_preconditioner();
    void renew_multigrid();
    bool solve_batch(const Eigen::MatrixXd& right, Eigen::Ref<Eigen::MatrixXd> x);
    bool iterate(const Columns& right, double tolerance, Columns& x);
    bool probe();

    MatrixSolverOptions options_;
    std::vector<Vec3> nodes_;
    FreeDofs free_;
    std::vector<std::uint8_t> held_;  ///< [num_dofs]
    std::unique_ptr<Backend> backend_;
    std::unique_ptr<Backend> single_;  ///< for multigrid within double precision
    BlockMatrix constrained_;
    std::unique_ptr<DeviceOperator> matrix_;  ///< on `backend_`
    std::optional<Hierarchy> hierarchy_;
    std::unique_ptr<DeviceOperator> smoothed_;  ///< level 0 of the hierarchy
    Multigrid* multigrid_ = nullptr;            ///< inside `preconditioner_`
    std::unique_ptr<Preconditioner> preconditioner_;
    std::optional<BlockCg> cg_;
    std::mutex mutex_;
    bool is_new_ = false;       ///< the preconditioner is that of the present matrix
    bool is_worn_out_ = false;  ///< too many iterations with it
    bool is_suspect_ = false;   ///< the matrix before was not positive definite
    bool is_indefinite_ = false;
    int iterations_when_new_ = 0;
    std::string failure_;
};

double GradientSolver::mean_diagonal(const BlockMatrix& matrix) const {
    double sum = 0;
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
            for (int i = 0; i < 3 && matrix.graph.items[k] == n; ++i)
                if (!held_[3 * n + i]) sum += std::abs(matrix.block(k)[4 * i]);
    return sum / free_.count;
}

void GradientSolver::constrain(const BlockMatrix& matrix, double shift) {
    const double added = shift > 0 ? shift * mean_diagonal(matrix) : 0;
    const Adjacency& graph = constrained_.graph;
    parallel_ranges(matrix.num_rows(), rows_per_thread, [&](Index begin, Index end) {
        for (Index n = begin; n < end; ++n)
            for (Index k = graph.offsets[n]; k < graph.offsets[n + 1]; ++k) {
                const Index m = graph.items[k];
                const double* from = matrix.block(k);
                double* to = constrained_.block(k);
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j) {
                        const bool is_diagonal = n == m && i == j;
                        const bool is_held = held_[3 * n + i] || held_[3 * m + j];
                        to[3 * i + j] = is_held ? (is_diagonal ? 1 : 0)
                                                : from[3 * i + j] + (is_diagonal ? added : 0);
                    }
            }
    });
}

std::vector<double> GradientSolver::inverse_diagonal() const {
    std::vector<double> inverse(9 * nodes_.size());
    const Adjacency& graph = constrained_.graph;
    for (Index n = 0; n < constrained_.num_rows(); ++n)
        for (Index k = graph.offsets[n]; k < graph.offsets[n + 1]; ++k)
            if (graph.items[k] == n)
                Eigen::Map<Mat3>(inverse.data() + 9 * static_cast<std::size_t>(n)) =
                    Eigen::Map<const Mat3>(constrained_.block(k)).inverse();
    return inverse;
}

void GradientSolver::renew_preconditioner() {
    if (options_.method == LinearMethod::multigrid) {
        renew_multigrid();
        if (!matrix_) matrix_ = backend_->make_operator(constrained_, {});
        backend_->set_values(*matrix_, constrained_, {});
    } else {
        const std::vector<double> inverse = inverse_diagonal();
        if (!matrix_) matrix_ = backend_->make_operator(constrained_, inverse);
        backend_->set_values(*matrix_, constrained_, inverse);
        if (!preconditioner_) preconditioner_ = make_block_jacobi(*backend_, *matrix_);
    }
    if (!cg_) cg_.emplace(*backend_, *matrix_, *preconditioner_, Curvature::watched);
    is_new_ = true;
    is_worn_out_ = false;
    iterations_when_new_ = 0;
}

void GradientSolver::renew_multigrid() {
    Backend& device = single_ ? *single_ : *backend_;
    if (hierarchy_)
        hierarchy_->update(constrained_);
    else
        hierarchy_.emplace(nodes_, held_, constrained_);
    const std::vector<double>& inverse = hierarchy_->levels()[0].inverse_diagonal;
    if (multigrid_) {
        device.set_values(*smoothed_, constrained_, inverse);
        multigrid_->update(*hierarchy_);
    } else {
        smoothed_ = device.make_operator(constrained_, inverse);
        auto multigrid = std::make_unique<Multigrid>(device, *smoothed_, *hierarchy_);
        multigrid_ = multigrid.get();
        preconditioner_ = std::move(multigrid);
        if (single_)
            preconditioner_ =
                make_precision_bridge(*backend_, *single_, std::move(preconditioner_));
    }
    hierarchy_->drop_values();
}

bool GradientSolver::solve_batch(const Eigen::MatrixXd& right, Eigen::Ref<Eigen::MatrixXd> x) {
    Columns unit = right;
    for (std::size_t d = 0; d < held_.size(); ++d)
        if (held_[d]) unit.row(d).setZero();
    const Eigen::RowVectorXd length = unit.colwise().norm();
    for (Eigen::Index c = 0; c < unit.cols(); ++c)
        if (length[c] > 0) unit.col(c) /= length[c];
    Columns found;
    if (!iterate(unit, options_.relative_tolerance, found)) return false;
    for (std::size_t d = 0; d < held_.size(); ++d)
        if (!held_[d]) x.row(d) = found.row(d).cwiseProduct(length);
    return true;
}

/// K x = right for columns of length 1, or 0. A preconditioner of an earlier matrix gets a second
/// chance as one of this matrix.
bool GradientSolver::iterate(const Columns& right, double tolerance, Columns& x) {
    const std::vector<double> target(right.cols(), tolerance);
    try {
        const int iterations = cg_->solve(right, target, options_.max_iterations, x);
        if (cg_->met_negative_curvature())
            return finds_indefinite("the tangent is not positive definite");
        if (iterations >= options_.max_iterations) {
            if (!is_new_) {
                renew_preconditioner();
                return iterate(right, tolerance, x);
            }
            failure_ = std::to_string(iterations) +
                       " conjugate gradients do not solve with the tangent: factorise it, or use "
                       "double precision";
            return false;
        }
        if (is_new_) iterations_when_new_ = std::max(iterations_when_new_, iterations);
        is_worn_out_ = iterations > worn_out * iterations_when_new_ + spare_iterations;
    } catch (const Error& error) {
        return fails(error);
    }
    return true;
}

/// Looks for negative curvature along the way to the solution for any right-hand side.
bool GradientSolver::probe() {
    std::minstd_rand random(1);
    Columns right(static_cast<Eigen::Index>(held_.size()), 1);
    for (std::size_t d = 0; d < held_.size(); ++d)
        right(d, 0) = held_[d] ? 0.0 : 2.0 * random() / random.max() - 1.0;
    right /= right.norm();
    Columns x;
    return iterate(right, probe_tolerance, x);
}

}  // namespace

std::unique_ptr<MatrixSolver> make_gradient_solver(const MatrixSolverMesh& mesh,
                                                   const MatrixSolverOptions& options) {
    return std::make_unique<GradientSolver>(mesh, options);
}

}  // namespace palpate

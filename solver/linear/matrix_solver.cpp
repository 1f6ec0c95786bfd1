// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/matrix_solver.hpp"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "solver/base/error.hpp"
#include "solver/linear/factor_libraries.hpp"
#include "solver/linear/free_lower.hpp"

namespace palpate {
namespace {

/// Up to here the host factorises, measured through PoCL on two cores (docs/performance.md): at
/// 5,000 degrees of freedom a whole simulation takes 0.28 s so and 0.34 s with multigrid, at 15,000
/// 0.85 s and 0.75 s.
constexpr std::size_t most_direct_dofs = 8000;
/// Of a mesh in a plane, whose factor grows far more slowly: a Newton step of 4,784 quadrilaterals
/// about an axis in contact takes 0.07 s so, and 3 s with multigrid.
constexpr std::size_t most_flat_dofs = 1000000;
/// Up to here Eigen's factor, which has nothing to set up, is done before MUMPS begins.
constexpr Index most_simple_dofs = 3000;

bool is_flat(std::span<const Vec3> nodes) {
    return std::all_of(nodes.begin(), nodes.end(),
                       [&](const Vec3& node) { return node.z() == nodes.front().z(); });
}

std::string library_for(Index num_free, const std::string& wanted) {
    return wanted.empty() && num_free <= most_simple_dofs ? "eigen" : wanted;
}

class FactorSolver final : public MatrixSolver {
public:
    FactorSolver(const MatrixSolverMesh& mesh, const MatrixSolverOptions& options)
        : free_(number_free_dofs(mesh.graph, mesh.prescribed)),
          lower_(mesh.graph, free_),
          factor_(make_sparse_factor(library_for(free_.count, options.direct_library))) {}

    bool set(const BlockMatrix& matrix, double shift) override {
        is_indefinite_ = false;
        if (free_.count == 0) return true;
        const SparseFactor::Lower& lower = lower_.fill(matrix, shift);
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

    bool is_direct() const override { return true; }
    bool is_indefinite() const override { return is_indefinite_; }
    const std::string& failure() const override { return failure_; }
    LinearSolverInfo describe() const override {
        return host_factor_info(factor_->library(), "asked for");
    }

private:
    FreeDofs free_;
    FreeLower lower_;
    std::unique_ptr<SparseFactor> factor_;
    bool is_analysed_ = false;
    bool is_indefinite_ = false;
    std::string failure_;
};

/// Multigrid on a back end until it fails where a factor does not; from then on the factor.
class AutomaticSolver final : public MatrixSolver {
public:
    AutomaticSolver(const MatrixSolverMesh& mesh, const MatrixSolverOptions& options)
        : options_(options),
          nodes_(mesh.nodes.begin(), mesh.nodes.end()),
          prescribed_(mesh.prescribed.begin(), mesh.prescribed.end()),
          matrix_{.graph = mesh.graph,
                  .num_columns = static_cast<Index>(mesh.nodes.size()),
                  .blocks = {}} {
        const std::string size = std::to_string(prescribed_.size()) + " degrees of freedom: ";
        if (options.backend == "reference")
            factorise_because("the reference back end solves directly");
        else if (prescribed_.size() <= (is_flat(nodes_) ? most_flat_dofs : most_direct_dofs))
            factorise_because(size + "factorising on the host is cheapest");
        else
            use_device_because(size + "a factorisation would not pay");
    }

    bool set(const BlockMatrix& matrix, double shift) override {
        if (!device_) return factor_->set(matrix, shift);
        matrix_.blocks = matrix.blocks;
        shift_ = shift;
        is_indefinite_ = false;
        return device_does([&] { return device_->set(matrix, shift); }) || fall_back();
    }

    bool solve(const Eigen::MatrixXd& right, Eigen::Ref<Eigen::MatrixXd> x) override {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (device_ && device_does([&] { return device_->solve(right, x); })) return true;
            if (device_ && !fall_back()) return false;
        }
        return factor_->solve(right, x);  // from any number of threads
    }

    bool is_direct() const override { return !device_; }
    bool is_indefinite() const override {
        return device_ ? is_indefinite_ : factor_->is_indefinite();
    }
    const std::string& failure() const override { return factor_ ? factor_->failure() : none_; }
    LinearSolverInfo describe() const override {
        LinearSolverInfo info = device_ ? device_->describe() : factor_->describe();
        info.reason = reason_;
        return info;
    }

private:
    MatrixSolverMesh mesh() const { return {nodes_, prescribed_, matrix_.graph}; }

    void factorise_because(const std::string& reason) {
        factor_ = make_factor_solver(mesh(), options_);
        reason_ = reason;
    }

    void use_device_because(const std::string& reason) {
        options_.method = LinearMethod::multigrid;
        const bool is_made = device_does([&] {
            device_ = make_gradient_solver(mesh(), options_);
            return true;
        });
        if (is_made)
            reason_ = reason;
        else
            factorise_because("no device: " + device_failure_);
    }

    /// Whether `work` succeeds. That there is no device to work with is a failure like any other.
    template <class Work>
    bool device_does(const Work& work) {
        try {
            if (work()) return true;
            device_failure_ = device_->failure();
        } catch (const Error& error) {
            const ErrorCode code = error.code();
            if (code != ErrorCode::device_unavailable && code != ErrorCode::kernel_build_failed)
                throw;  // a device that breaks while it works is told
            device_failure_ = error.what();
        }
        return false;
    }

    /// Whether the matrix that the device failed at has a factor: it then serves from now on.
    bool fall_back() {
        if (!factor_) factor_ = make_factor_solver(mesh(), options_);
        is_indefinite_ = !factor_->set(matrix_, shift_);
        if (is_indefinite_) return false;  // both agree
        device_.reset();
        reason_ = "the device gave up: " + device_failure_;
        return true;
    }

    MatrixSolverOptions options_;
    std::vector<Vec3> nodes_;
    std::vector<std::uint8_t> prescribed_;
    BlockMatrix matrix_;  ///< that `set` brought
    double shift_ = 0;
    std::unique_ptr<MatrixSolver> device_;  ///< while it serves
    std::unique_ptr<MatrixSolver> factor_;
    std::mutex mutex_;
    bool is_indefinite_ = false;
    std::string reason_, device_failure_, none_;
};

}  // namespace

std::unique_ptr<MatrixSolver> make_factor_solver(const MatrixSolverMesh& mesh,
                                                 const MatrixSolverOptions& options) {
    return std::make_unique<FactorSolver>(mesh, options);
}

std::unique_ptr<MatrixSolver> make_matrix_solver(const MatrixSolverMesh& mesh,
                                                 const MatrixSolverOptions& options) {
    switch (options.method) {
        case LinearMethod::automatic:
            return std::make_unique<AutomaticSolver>(mesh, options);
        case LinearMethod::direct:
            return make_factor_solver(mesh, options);
        default:
            return make_gradient_solver(mesh, options);
    }
}

MatrixSolverOptions matrix_solver_options(const LinearSolverOptions& options) {
    MatrixSolverOptions chosen;
    chosen.method = options.method;
    chosen.direct_library = options.direct_library;
    chosen.backend = options.backend;
    chosen.device = options.device;
    return chosen;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/contenders.hpp"

#include "bench/peers/peer.hpp"
#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/make_linear_solver.hpp"

namespace palpate::bench {
namespace {

class OurContender final : public Contender {
public:
    OurContender(const LinearSolverOptions& options, const BenchMesh& mesh,
                 const LinearProblem& problem)
        : options_(options), mesh_(mesh), problem_(problem) {
        options_.expected_columns = static_cast<Index>(problem.b.cols());
    }

    void set_up() override { solver_ = make_linear_solver(mesh_.model, options_); }

    double solve() override {
        x_.resize(0, 0);
        const LinearSolverSummary summary = solver_->solve(problem_.b, x_);
        if (!summary.converged) throw Error(ErrorCode::solve_failed, summary.message);
        const Index columns = static_cast<Index>(problem_.b.cols());
        const Index batches =
            (columns + options_.columns_per_batch - 1) / options_.columns_per_batch;
        return double(summary.iterations) / batches;  // the columns of a batch iterate together
    }

    Columns answer() const override { return x_; }

    std::string describe() const override {
        const LinearSolverInfo info = solver_->describe();
        return std::string(name_of(info.method)) + " (" + info.reason + "), " +
               (info.library.empty() ? info.device.device : info.library) + ", " +
               (info.device.precision == Precision::single ? "fp32" : "fp64");
    }

private:
    LinearSolverOptions options_;
    const BenchMesh& mesh_;
    const LinearProblem& problem_;
    std::unique_ptr<LinearSolver> solver_;
    Columns x_;
};

class PeerContender final : public Contender {
public:
    PeerContender(std::unique_ptr<Peer> peer, const BenchMesh& mesh, const LinearProblem& problem)
        : peer_(std::move(peer)),
          problem_(problem),
          matrix_(assemble_free_matrix(mesh.model)),
          b_(free_rhs(mesh.model, problem.b)(matrix_.dofs, Eigen::all)) {}

    void set_up() override { peer_->set_up(matrix_); }

    double solve() override {
        return double(peer_->solve(b_, x_, relative_tolerance)) / double(b_.cols());
    }

    Columns answer() const override {
        Columns x = problem_.b;  // the prescribed displacement at prescribed dofs
        x(matrix_.dofs, Eigen::all) = x_;
        return x;
    }

    std::string describe() const override { return peer_->describe(); }

private:
    std::unique_ptr<Peer> peer_;
    const LinearProblem& problem_;
    FreeMatrix matrix_;
    Columns b_, x_;
};

struct OurEntry {
    std::string name;
    LinearSolverOptions options;
    Index most_dofs = 0;  ///< 0: any number
};

LinearSolverOptions options_for(const std::string& backend, LinearMethod method) {
    LinearSolverOptions options;
    options.backend = backend;
    options.method = method;
    options.relative_tolerance = relative_tolerance;
    return options;
}

/// Every way of ours to solve. The direct solver works on the host, whatever the back end.
std::vector<OurEntry> our_entries() {
    constexpr Index most_dofs_direct = 400000;  // a factor of a million takes tens of GiB
    std::vector<OurEntry> entries;
    for (const BackendEntry& backend : backend_registry()) {
        if (backend.name == "reference") continue;
        for (LinearMethod method :
             {LinearMethod::automatic, LinearMethod::multigrid, LinearMethod::jacobi})
            entries.push_back({"palpate_" + backend.name + "_" + name_of(method),
                               options_for(backend.name, method)});
    }
    entries.push_back(
        {"palpate_direct", options_for("reference", LinearMethod::direct), most_dofs_direct});
    return entries;
}

}  // namespace

std::vector<ContenderEntry> contenders() {
    std::vector<ContenderEntry> all;
    for (const OurEntry& entry : our_entries())
        all.push_back({entry.name, false, entry.most_dofs,
                       [options = entry.options](const BenchMesh& mesh, const LinearProblem& p) {
                           return std::make_unique<OurContender>(options, mesh, p);
                       }});
    for (const PeerEntry& peer : peer_registry())
        all.push_back({peer.name, peer.name.starts_with("petsc"), 0,
                       [make = peer.make](const BenchMesh& mesh, const LinearProblem& p) {
                           return std::make_unique<PeerContender>(make(), mesh, p);
                       }});
    return all;
}

}  // namespace palpate::bench

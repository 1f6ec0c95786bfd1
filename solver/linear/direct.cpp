// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/direct.hpp"

#include <utility>

#include "solver/linear/direct_columns.hpp"

namespace palpate {
namespace {

class DirectSolver final : public LinearSolver {
public:
    DirectSolver(const Model& model, const LinearSolverOptions& options, std::string reason)
        : reason_(std::move(reason)), system_(model), columns_(system_, options) {}

    LinearSolverInfo describe() const override { return columns_.describe(reason_); }

    void set_stiffness(std::span<const double> stiffness_kpa) override {
        system_.set_stiffness(stiffness_kpa);
        columns_.factorise();
    }

    LinearSolverSummary solve(const Columns& b, Columns& x, const ProgressSink& progress) override {
        return columns_.solve(b, x, progress);
    }

private:
    std::string reason_;
    ConstrainedSystem system_;
    DirectColumns columns_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_direct_solver(const Model& model,
                                                 const LinearSolverOptions& options,
                                                 std::string reason) {
    return std::make_unique<DirectSolver>(model, options, std::move(reason));
}

}  // namespace palpate

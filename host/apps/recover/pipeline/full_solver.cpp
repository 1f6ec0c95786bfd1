// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/full_solver.hpp"

#include <utility>

#include "solver/equilibrium/rest_solver.hpp"

namespace palpate {

FullSolver::FullSolver(SolidModel model, LinearSolverOptions options, Index num_columns,
                       std::launch when) {
    options.expected_columns = num_columns;
    set_up_ = std::async(when, [model = std::move(model), options = std::move(options)] {
        return make_rest_solver(model, options);
    });
}

LinearSolver& FullSolver::at(const std::vector<double>& kpa) {
    if (!solver_) solver_ = set_up_.get();
    solver_->set_stiffness(kpa);
    return *solver_;
}

}  // namespace palpate

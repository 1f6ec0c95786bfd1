// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <memory>
#include <vector>

#include "solver/linear/linear_solver.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// The linear solver of the whole, uncondensed model for any moduli. It is set up in the
/// background, at the moduli of the model, so that ordering and storage are there when a search
/// ends; only numbers change after that.
class FullSolver {
public:
    /// `num_columns`: right-hand sides to be expected per set of moduli. `when`: deferred sets up
    /// at the first call of `at`.
    FullSolver(SolidModel model, LinearSolverOptions options, Index num_columns,
               std::launch when = std::launch::async);
    /// Waits for the set-up. `kpa`: moduli of all regions [num regions]. Throws what
    /// `make_rest_solver` throws.
    LinearSolver& at(const std::vector<double>& kpa);

private:
    std::future<std::unique_ptr<LinearSolver>> set_up_;
    std::unique_ptr<LinearSolver> solver_;
};

}  // namespace palpate

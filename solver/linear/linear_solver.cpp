// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/linear_solver.hpp"

#include "solver/backend/registry.hpp"
#include "solver/linear/block_cg.hpp"
#include "solver/linear/direct.hpp"

namespace palpate {

std::unique_ptr<LinearSolver> make_linear_solver(const Model& model,
                                                 const LinearSolverOptions& options) {
    if (options.backend == "reference") return make_direct_solver(model, options);
    return make_block_cg_solver(model, make_backend(options.backend, options.device), options);
}

}  // namespace palpate

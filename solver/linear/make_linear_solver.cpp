// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/make_linear_solver.hpp"

#include <utility>

#include "solver/backend/registry.hpp"
#include "solver/linear/cg_solver.hpp"
#include "solver/linear/direct.hpp"

namespace palpate {

std::unique_ptr<LinearSolver> make_linear_solver(const Model& model,
                                                 const LinearSolverOptions& options) {
    std::unique_ptr<Backend> backend = make_backend(options.backend, options.device);
    MethodChoice choice = choose_method(options, model.num_dofs(), backend->describe());
    if (choice.method == LinearMethod::direct)
        return make_direct_solver(model, options, std::move(choice.reason));
    return make_cg_solver(model, std::move(backend), options, std::move(choice));
}

}  // namespace palpate

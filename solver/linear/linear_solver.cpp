// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/linear_solver.hpp"

#include "solver/backend/registry.hpp"
#include "solver/linear/cg_solver.hpp"
#include "solver/linear/direct.hpp"

namespace palpate {

const char* name_of(LinearMethod method) {
    switch (method) {
        case LinearMethod::automatic:
            return "auto";
        case LinearMethod::multigrid:
            return "multigrid";
        case LinearMethod::jacobi:
            return "jacobi";
        case LinearMethod::direct:
            return "direct";
    }
    return "";
}

std::unique_ptr<LinearSolver> make_linear_solver(const Model& model,
                                                 const LinearSolverOptions& options) {
    std::unique_ptr<Backend> backend = make_backend(options.backend, options.device);
    MethodChoice choice = choose_method(options, model.num_dofs(), backend->describe());
    if (choice.method == LinearMethod::direct)
        return make_direct_solver(model, options, std::move(choice.reason));
    return make_cg_solver(model, std::move(backend), options, std::move(choice));
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/linear_solver.hpp"

#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/block_cg.hpp"
#include "solver/linear/choose_method.hpp"
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
    switch (choice.method) {
        case LinearMethod::direct:
            return make_direct_solver(model, options, std::move(choice.reason));
        case LinearMethod::multigrid:
            throw Error(ErrorCode::unsupported,
                        "The multigrid solver is not in this build; choose auto, jacobi or "
                        "direct.");
        default:
            return make_block_cg_solver(model, std::move(backend), options,
                                        std::move(choice.reason));
    }
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/linear_solver.hpp"

#include "solver/base/parallel.hpp"

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

LinearSolverInfo host_factor_info(const std::string& library, const std::string& reason) {
    BackendInfo host;
    host.backend = "reference";
    host.device = "host";
    host.compute_units = num_host_threads();
    host.version = library;
    return {host, LinearMethod::direct, library, reason};
}

}  // namespace palpate

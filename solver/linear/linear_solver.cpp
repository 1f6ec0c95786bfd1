// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/linear_solver.hpp"

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

}  // namespace palpate

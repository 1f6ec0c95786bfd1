// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "solver/linear/linear_solver.hpp"

namespace palpate {

struct MethodChoice {
    LinearMethod method = LinearMethod::direct;  ///< never `automatic`
    std::string reason;                          ///< one clause, for `LinearSolverInfo`
};

/// What `options.method` asks for, or for `automatic` the method that is expected to be done first
/// with `options.expected_columns` right-hand sides, set-up included, on `device`.
/// Pure: in one build the same arguments give the same choice on every machine.
MethodChoice choose_method(const LinearSolverOptions& options, Index num_dofs,
                           const BackendInfo& device);

}  // namespace palpate

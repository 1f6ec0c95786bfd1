// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Factorises K of the free dofs once per set of moduli (with `options.direct_library`) and solves
/// all columns in batches shared among the host threads, fp64, refined to the tolerance.
/// Throws Error(solve_failed) if the free dofs are not held against rigid motion,
/// Error(out_of_memory) if the factor does not fit, Error(unsupported) for an absent library.
std::unique_ptr<LinearSolver> make_direct_solver(const Model& model,
                                                 const LinearSolverOptions& options,
                                                 std::string reason = "asked for");

}  // namespace palpate

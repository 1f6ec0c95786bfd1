// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Factors K of the free dofs once per set of moduli (Eigen simplicial LDL^T, approximate minimum
/// degree ordering) and solves all columns in batches shared among the host threads, fp64.
/// Throws Error(solve_failed) if the free dofs are not held against rigid motion.
std::unique_ptr<LinearSolver> make_direct_solver(const Model& model,
                                                 const LinearSolverOptions& options,
                                                 std::string reason = "asked for");

}  // namespace palpate

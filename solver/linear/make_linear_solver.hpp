// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Builds the solver for `model` (copied) that `choose_method` picks: a factorisation on the host,
/// or conjugate gradients with fp64 refinement on `options.backend`.
/// Throws Error(unsupported) for a method or back end that this build does not have.
std::unique_ptr<LinearSolver> make_linear_solver(const Model& model,
                                                 const LinearSolverOptions& options);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/linear/choose_method.hpp"

namespace palpate {

/// Block conjugate gradients on `backend`, preconditioned as `choice.method` says (jacobi or
/// multigrid), wrapped in iterative refinement: residuals are computed on the host in fp64 until
/// every column meets the tolerance (Higham, Accuracy and Stability of Numerical Algorithms, 2002,
/// chapter 12), whatever the precision of the device.
std::unique_ptr<LinearSolver> make_cg_solver(const Model& model, std::unique_ptr<Backend> backend,
                                             const LinearSolverOptions& options,
                                             MethodChoice choice);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Conjugate gradients on the operations of `Backend`, preconditioned with the inverse 3x3 diagonal
/// blocks (Saad, Iterative Methods for Sparse Linear Systems, 2003, algorithm 9.1), for several
/// independent columns that share each pass over the mesh: every column has its own step lengths,
/// and a converged column stands still.
class BlockCg {
public:
    /// `backend` is prepared and outlives this object. Allocates five vectors on the device.
    BlockCg(Backend& backend, Index rows, Index columns);

    /// Solves K dx = r with the constrained K, starting at zero.
    ///   r, dx      [rows, columns], 0 at prescribed dofs
    ///   target     [columns] |r - K dx| to reach; a column whose |r| is below stays at zero
    /// Returns the number of iterations, at most `max_iterations`. A column also stops when p . K p
    /// is not positive (rounding has eaten it). Throws Error(solve_failed) on NaN.
    int solve(const Columns& r, std::span<const double> target, int max_iterations, Columns& dx);

private:
    Backend& backend_;
    std::unique_ptr<DeviceVector> r_, z_, p_, q_, x_;
};

/// Block CG on `backend`, wrapped in iterative refinement: residuals are computed on the host in
/// fp64 until every column meets the tolerance (Higham, Accuracy and Stability of Numerical
/// Algorithms, 2002, chapter 12), whatever the precision of the device.
std::unique_ptr<LinearSolver> make_block_cg_solver(const Model& model,
                                                   std::unique_ptr<Backend> backend,
                                                   const LinearSolverOptions& options,
                                                   std::string reason = "asked for");

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Derivatives of a scalar J(u) where K(E) u = 0 on free dofs and u is given on prescribed dofs.
struct AdjointGradient {
    Eigen::VectorXd displacement;   ///< [3 num_nodes] dJ/du at prescribed dofs (total), 0 elsewhere
    Eigen::VectorXd stiffness_kpa;  ///< [num materials] dJ/dE_r
};

/// One adjoint solve: K_ff lambda = -(dJ/du)_f, lambda = 0 on prescribed dofs, then
/// dJ/du_p = (dJ/du)_p + K_pf lambda and dJ/dE_r = lambda . K_r u.
///   u      [3 num_nodes] mm, the forward solution
///   dj_du  [3 num_nodes] partial derivative of J
/// `stiffness_kpa` are the moduli of `solver`. Throws Error(solve_failed) if the solve misses its
/// tolerance.
AdjointGradient adjoint_gradient(const Model& model, LinearSolver& solver, const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& dj_du);

/// The same for J = sum over columns of J_c(u_c) with K(E) u = f: derivatives by everything that
/// the right-hand sides of `LinearSolver::solve` hold.
struct LoadGradient {
    Columns load;  ///< [3 num_nodes, columns] per mN at free, mm at prescribed dofs
    Eigen::VectorXd stiffness_kpa;  ///< [num materials] dJ/dE_r
};

/// One solve for all columns.
///   u      [3 num_nodes, columns] mm, the forward solutions
///   dj_du  [3 num_nodes, columns]
/// Throws as `adjoint_gradient` does.
LoadGradient load_gradient(const Model& model, LinearSolver& solver, const Columns& u,
                           const Columns& dj_du, const ProgressSink& progress = {});

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/equilibrium/newton.hpp"

namespace palpate {

/// Derivatives of a scalar J(u) of an equilibrium at large deformation.
struct SolidGradient {
    /// [materials][parameters] per unit of each parameter.
    std::vector<std::vector<double>> parameters;
    Eigen::VectorXd force;         ///< [3 num_nodes] per mN at free dofs, 0 elsewhere
    Eigen::VectorXd displacement;  ///< [3 num_nodes] per mm at prescribed dofs (total), 0 elsewhere
    std::vector<double> pressure_kpa;  ///< [model.pressures] per kPa of those that follow
};

inline constexpr const char* no_gradient_where_unstable =
    "the tangent at the equilibrium is not positive definite, so its gradient is not defined; the "
    "body is not stable there";

/// Throws Error(invalid_argument) for slopes with the wrong number of rows, Error(unsupported) for
/// an equilibrium without its tangent.
void check_gradient_input(const SolidAssembly& solid, const Equilibrium& found, Eigen::Index rows);

/// One solve with the tangent at an equilibrium u, K_ff^T lambda = (dJ/du)_f, lambda = 0 on
/// prescribed dofs; then
///   dJ/dp = -lambda . df/dp,  dJ/dforce = lambda,  dJ/du_p = (dJ/du)_p - (K^T lambda)_p,
/// and for a following pressure P with forces P c(u)  dJ/dP = lambda . c.
///   found   from `solve_equilibrium` with `solid`; its factor is used again
///   dj_du   [3 num_nodes] partial derivative of J
/// Throws Error(invalid_argument) for a wrong size, Error(unsupported) for a state of
/// `solve_history`, Error(solve_failed) if the tangent is not positive definite: u is not stable.
SolidGradient solid_gradient(const SolidAssembly& solid, const Equilibrium& found,
                             const Eigen::VectorXd& dj_du);

}  // namespace palpate

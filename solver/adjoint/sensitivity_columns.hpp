// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "solver/equilibrium/newton.hpp"

// Many derivatives of one equilibrium at once: batches of right-hand sides for one factor of its
// tangent. All throw as `solid_gradient` does. `palpate identify` does not
// come here: its derivatives go forward through load histories (solver/sensitivity), on the host.
namespace palpate {

/// The solutions of K_ff^T Lambda_f = (dJ/du)_f, Lambda = 0 on prescribed dofs, for many
/// objectives: dJ/dforce of each.
///   found   from `solve_equilibrium` with `solid`
///   dj_du   [3 num_nodes, objectives]
Eigen::MatrixXd adjoint_columns(const SolidAssembly& solid, const Equilibrium& found,
                                const Eigen::MatrixXd& dj_du);

/// du/dp for every parameter of every material: [materials][3 num_nodes, parameters], mm per unit.
std::vector<Eigen::MatrixXd> parameter_columns(const SolidAssembly& solid,
                                               const Equilibrium& found);

/// du/du_p for these prescribed dofs: [3 num_nodes, dofs]; 1 at the dof itself.
Eigen::MatrixXd displacement_columns(const SolidAssembly& solid, const Equilibrium& found,
                                     std::span<const Index> dofs);

}  // namespace palpate

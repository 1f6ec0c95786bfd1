// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/linear/linear_solver.hpp"
#include "solver/model/solid_model.hpp"
#include "solver/model/stiffness_matrix.hpp"

namespace palpate {

/// K of a body at rest without regard to prescribed dofs, mN/mm: the tangent of its laws at u = 0,
/// for every element of the registry. Throws Error(invalid_argument) as `check_model` does.
StiffnessMatrix stiffness_at_rest(const SolidModel& model);

/// Solves K x = b with the K of `stiffness_at_rest` and the model's prescribed dofs. Linear
/// tetrahedra of linear elasticity (`is_linear_tet4`) go the way of `make_linear_solver(Model)`, on
/// the back end that `options` name; all others are factorised on the host, and `describe` says so.
/// `set_stiffness` changes the first parameter of every material. Throws what that function throws,
/// Error(unsupported) if conjugate gradients are asked for of other elements.
std::unique_ptr<LinearSolver> make_rest_solver(const SolidModel& model,
                                               const LinearSolverOptions& options);

}  // namespace palpate

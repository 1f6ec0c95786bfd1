// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "host/page/result_tree.hpp"
#include "solver/equilibrium/element_loops.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Who solved linear systems, as results of all applications tell it: method, library, backend,
/// device, reason.
ResultTree solver_part(std::string name, const LinearSolverInfo& solver);
/// The same into `tree`; null where nobody did.
void add_solver(std::string name, const std::optional<LinearSolverInfo>& solver, ResultTree& tree);
/// Who had the element loops, into `tree`: backend, device, reason, and in words under "Element
/// loops"; null where there were none.
void add_loops(std::string name, const std::optional<ElementLoopInfo>& loops, ResultTree& tree);

/// "direct, Eigen 3.4.0 LDLT on host (asked for)".
std::string solver_text(const LinearSolverInfo& solver);

}  // namespace palpate

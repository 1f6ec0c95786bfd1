// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/pipeline/full_solver.hpp"
#include "host/apps/recover/pipeline/recovered.hpp"

namespace palpate {

/// Writes the estimated moduli into the model, solves the uncondensed equilibrium with the
/// estimated wall motion, and takes the forces as reactions, f = K u. Throws
/// Error(solve_failed) if the solve misses its tolerance or leaves the condensed solution.
void solve_full_model(Recovered& found, FullSolver& solver, const ProgressSink& progress);

/// The same at large deformation, from the equilibrium that the search ended with.
void take_equilibrium(Recovered& found);

}  // namespace palpate

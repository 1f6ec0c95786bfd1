// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/faces/capi/palpate.h"
#include "solver/linear/linear_solver.hpp"

namespace palpate::capi {

/// Null: the defaults. Throws Error(invalid_argument) naming what is out of range, and
/// Error(device_unavailable).
LinearSolverOptions linear_solver_options(const palpate_solver_options* given);

}  // namespace palpate::capi

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/simulate/simulation_settings.hpp"

namespace palpate {

/// Halves all cells of a mesh that is made here. False, and nothing done, for one of a file.
bool halve_cells(SimulationSettings& settings);
/// Halves all time steps, loads being linear in between; the first one only if every load has a
/// column, because others act in full from the first time on. False for a static load or a motion.
bool halve_steps(SimulationSettings& settings);

/// Takes two cells of a graded mesh together in each direction: the lines of the coarser mesh are
/// lines of this one. False, and nothing done, for other meshes, for numbers of cells that are odd,
/// and for cells that are divided by an odd number.
bool double_cells(SimulationSettings& settings);
/// Takes two time steps together. False for an odd number of them, a static load or a motion.
bool double_steps(SimulationSettings& settings);

}  // namespace palpate

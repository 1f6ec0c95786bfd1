// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/simulate/simulation_settings.hpp"

namespace palpate {

/// A box of tetrahedra (six to a cell, conforming) or a rectangle of quadrilaterals or triangles
/// (two to a cell), all with label 1. Throws Error(invalid_argument) for another element type.
SolidMesh grid_mesh(const GridSettings& grid, Formulation formulation);

}  // namespace palpate

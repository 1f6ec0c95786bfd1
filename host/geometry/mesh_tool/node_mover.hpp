// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/mesh/mesh.hpp"

namespace palpate::mesh_tool {

/// What may happen to nodes on the given triangles: nothing, or sliding a little along a smooth
/// surface, or along the line where surfaces meet.
enum class SurfaceNodes { fixed, slide };

/// Moves nodes of tets with a dihedral angle below `goal_deg` so that the smallest angle round each
/// moved node grows. Deterministic; tets never turn over; nothing changes where no move helps.
void move_nodes_of_slivers(Mesh& mesh, const std::vector<Triangle>& triangles,
                           SurfaceNodes surface_nodes, double goal_deg);

}  // namespace palpate::mesh_tool

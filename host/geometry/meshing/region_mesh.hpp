// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/geometry/surfaces/surface.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate {

/// A tetrahedral mesh and the region surface it conforms to: `surface.vertices` are the first nodes
/// of the mesh or, for any mesher, `surface.triangles` index `mesh.nodes` directly (then
/// `surface.vertices` equals `mesh.nodes`). Tets carry region numbers; hollow regions hold no tets.
struct RegionMesh {
    Mesh mesh;
    RegionSurface surface;
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/mesh/mesh.hpp"

namespace palpate::mesh_tool {

/// The region of every tet of a mesh that keeps all `triangles` as faces: known on both sides of
/// each triangle from the vertex order alone, carried on across the other faces. Nothing is decided
/// by coordinates. Tets must have positive volume. `component` receives, per tet, the number of its
/// part of space (cut at the triangles).
/// Throws Error(mesh_failed) if a triangle is no face, or two sides disagree.
std::vector<Index> fill_regions(const std::vector<Tet>& tets,
                                const std::vector<Triangle>& triangles,
                                const std::vector<std::array<Index, 2>>& regions,
                                std::vector<Index>* component = nullptr);

/// All faces between tets of different regions or on the hull (region 0 beyond), with their two
/// regions; the normal points from regions[0], which is the one of the larger number, to
/// regions[1]. Tets must have positive volume.
void interfaces_between_regions(const Mesh& mesh, std::vector<Triangle>& triangles,
                                std::vector<std::array<Index, 2>>& regions);

}  // namespace palpate::mesh_tool

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// Of quadratic tetrahedra, about: a node of a mesh of tetrahedra has some six edges of its own.
constexpr Index quadratic_nodes_per_corner = 7;
constexpr Index pieces_of_tet10 = 8;  ///< in `linear_mesh_of`

/// The same mesh with straight quadratic elements: a node in the middle of every edge, after the
/// nodes there were, in the order in which edges are first met. tet4 becomes tet10, tri3 tri6.
/// Throws Error(invalid_argument) for other types.
SolidMesh with_edge_nodes(const SolidMesh& linear);

/// Linear tetrahedra on the same nodes: tet4 as they are, a tet10 as eight, one at each corner and
/// four round the diagonal of the octahedron between them. Throws Error(invalid_argument) for other
/// types.
Mesh linear_mesh_of(const SolidMesh& mesh);

/// The tetrahedra of the elements' corners alone, on the same nodes. Throws as `linear_mesh_of`.
Mesh corner_mesh_of(const SolidMesh& mesh);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// The same mesh with straight quadratic elements: a node in the middle of every edge, after the
/// nodes there were, in the order in which edges are first met. tet4 becomes tet10, tri3 tri6.
/// Throws Error(invalid_argument) for other types.
SolidMesh with_edge_nodes(const SolidMesh& linear);

}  // namespace palpate

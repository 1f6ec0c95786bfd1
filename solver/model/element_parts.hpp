// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/mesh/node_elements.hpp"
#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// The elements of a mesh in parts that lie together, so that a thread that goes through one finds
/// nodes and blocks of the matrix in its cache. Parts of one colour share no node: they may be
/// added to nodes at the same time, and colour after colour gives sums of a fixed order.
struct ElementParts {
    Adjacency elements;  ///< of each part; every element is in one
    Adjacency parts;     ///< of each colour
};
ElementParts element_parts(const SolidMesh& mesh);

}  // namespace palpate

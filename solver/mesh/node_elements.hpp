// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/mesh/mesh.hpp"

namespace palpate {

/// Lists of different length in two arrays: list i is items[offsets[i]] .. items[offsets[i + 1] -
/// 1].
struct Adjacency {
    std::vector<Index> offsets;  ///< [number of lists + 1]
    std::vector<Index> items;

    Index num_lists() const { return static_cast<Index>(offsets.size()) - 1; }
};

/// For every node the tet corners that sit on it, each as 4 tet + corner, ascending. Element loops
/// write [num_tets, 4, 3] values; summing these lists gathers them to nodes in a fixed order.
Adjacency corners_of_nodes(const Mesh& mesh);

/// For every node itself and the nodes that share a tet with it, ascending: the pattern of the
/// 3x3 block CSR stiffness. A node of no tet has only itself.
Adjacency node_graph(const Mesh& mesh);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solver/mesh/node_elements.hpp"

namespace palpate {

/// Nodes in connected groups: each group is one node of the next coarser level.
struct Aggregates {
    std::vector<Index> of_node;  ///< [num_nodes], -1 for nodes that belong to none
    Index count = 0;
};

/// Greedy aggregation (Vanek, Mandel, Brezina, Computing 56, 1996, section 5.1): first whole
/// neighbourhoods that touch no other, then the rest joins the aggregate to which it has most
/// edges, then what is left among itself. Depends on the graph only, not on moduli.
///   graph      symmetric, every node in its own list
///   takes_part [num_nodes] 0 for nodes without free dofs: they join none
Aggregates aggregate_nodes(const Adjacency& graph, std::span<const unsigned char> takes_part);

}  // namespace palpate

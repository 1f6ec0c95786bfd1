// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "solver/mesh/node_elements.hpp"

namespace palpate {

/// For every item of `corners` (`corners_of_nodes`) the positions of its tet's four nodes in the
/// row of `pattern` (`node_graph`) that belongs to the node: [4 num_tets, 4]. Throws
/// Error(unsupported) if a row has more than 65,535 blocks.
std::vector<std::uint16_t> corner_slots(const Mesh& mesh, const Adjacency& corners,
                                        const Adjacency& pattern);

/// Edges p1 - p0, p2 - p0, p3 - p0 of every tet: [num_tets, 9], mm.
std::vector<double> tet_edges(const Mesh& mesh);

/// Tets sorted by region (ascending within one), cut into chunks of one region each.
struct RegionChunks {
    std::vector<Index> order;   ///< [num_tets]
    std::vector<Index> start;   ///< [num_chunks + 1] into `order`
    std::vector<Index> region;  ///< [num_chunks]
};
RegionChunks region_chunks(const Mesh& mesh, Index num_regions, Index tets_per_chunk);

}  // namespace palpate

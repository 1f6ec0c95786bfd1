// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "solver/model/model.hpp"

namespace palpate {

/// Rows of variable length: row i is entry[start[i]] ... entry[start[i + 1] - 1].
struct RowTable {
    std::vector<Index> start;
    std::vector<Index> entry;
};

/// The corners of tets that meet at each node: entries are 4 tet + local node, ascending.
RowTable node_corners(const Mesh& mesh);

/// Where the 3x3 blocks of the stiffness stand: row i holds the nodes that share a tet with node i,
/// ascending, i itself always among them.
RowTable block_pattern(const Mesh& mesh, const RowTable& corners);

/// For every entry of `corners` the positions of its tet's four nodes in the block row of the node:
/// [4 num_tets, 4]. Throws Error(unsupported) if a row has more than 65,535 blocks.
std::vector<std::uint16_t> corner_slots(const Mesh& mesh, const RowTable& corners,
                                        const RowTable& pattern);

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

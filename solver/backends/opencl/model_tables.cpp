// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/model_tables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

// Counts per row, turned into row starts.
std::vector<Index> starts_of(std::vector<Index> counts) {
    counts.push_back(0);
    Index sum = 0;
    for (Index& count : counts) {
        const Index here = count;
        count = sum;
        sum += here;
    }
    return counts;
}

// Nodes of the tets at `node`, ascending, each once.
void neighbours_of(const Mesh& mesh, const RowTable& corners, Index node,
                   std::vector<Index>& neighbours) {
    neighbours.assign(1, node);
    for (Index k = corners.start[node]; k < corners.start[node + 1]; ++k) {
        const Tet& tet = mesh.tets[corners.entry[k] / 4];
        neighbours.insert(neighbours.end(), tet.begin(), tet.end());
    }
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
}

}  // namespace

RowTable node_corners(const Mesh& mesh) {
    RowTable table;
    std::vector<Index> counts(mesh.nodes.size(), 0);
    for (const Tet& tet : mesh.tets)
        for (Index node : tet) ++counts[node];
    table.start = starts_of(std::move(counts));
    table.entry.resize(4 * mesh.tets.size());
    std::vector<Index> next = table.start;
    for (Index t = 0; t < mesh.num_tets(); ++t)
        for (Index a = 0; a < 4; ++a) table.entry[next[mesh.tets[t][a]]++] = 4 * t + a;
    return table;
}

RowTable block_pattern(const Mesh& mesh, const RowTable& corners) {
    RowTable pattern;
    pattern.start.push_back(0);
    std::vector<Index> neighbours;
    for (Index node = 0; node < mesh.num_nodes(); ++node) {
        neighbours_of(mesh, corners, node, neighbours);
        pattern.entry.insert(pattern.entry.end(), neighbours.begin(), neighbours.end());
        pattern.start.push_back(static_cast<Index>(pattern.entry.size()));
    }
    return pattern;
}

std::vector<std::uint16_t> corner_slots(const Mesh& mesh, const RowTable& corners,
                                        const RowTable& pattern) {
    std::vector<std::uint16_t> slots;
    slots.reserve(4 * corners.entry.size());
    for (Index node = 0; node < mesh.num_nodes(); ++node) {
        const auto row = pattern.entry.begin() + pattern.start[node];
        const auto end = pattern.entry.begin() + pattern.start[node + 1];
        if (end - row > 65535)
            throw Error(ErrorCode::unsupported,
                        fmt::format("Node {} has {} neighbours, the OpenCL back end allows 65535: "
                                    "check the mesh or use the matrix-free product.",
                                    node, end - row));
        for (Index k = corners.start[node]; k < corners.start[node + 1]; ++k)
            for (Index other : mesh.tets[corners.entry[k] / 4])
                slots.push_back(
                    static_cast<std::uint16_t>(std::lower_bound(row, end, other) - row));
    }
    return slots;
}

std::vector<double> tet_edges(const Mesh& mesh) {
    std::vector<double> edges;
    edges.reserve(9 * mesh.tets.size());
    for (const Tet& tet : mesh.tets)
        for (int a = 1; a < 4; ++a) {
            const Vec3 edge = mesh.nodes[tet[a]] - mesh.nodes[tet[0]];
            edges.insert(edges.end(), edge.data(), edge.data() + 3);
        }
    return edges;
}

RegionChunks region_chunks(const Mesh& mesh, Index num_regions, Index tets_per_chunk) {
    RegionChunks chunks;
    std::vector<Index> counts(num_regions, 0);
    for (Index region : mesh.region) ++counts[region];
    const std::vector<Index> starts = starts_of(std::move(counts));
    chunks.order.resize(mesh.tets.size());
    std::vector<Index> next = starts;
    for (Index t = 0; t < mesh.num_tets(); ++t) chunks.order[next[mesh.region[t]]++] = t;
    for (Index region = 0; region < num_regions; ++region)
        for (Index at = starts[region]; at < starts[region + 1]; at += tets_per_chunk) {
            chunks.start.push_back(at);
            chunks.region.push_back(region);
        }
    chunks.start.push_back(mesh.num_tets());
    return chunks;
}

}  // namespace palpate

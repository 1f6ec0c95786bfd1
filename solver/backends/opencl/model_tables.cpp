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

}  // namespace

std::vector<std::uint16_t> corner_slots(const Mesh& mesh, const Adjacency& corners,
                                        const Adjacency& pattern) {
    std::vector<std::uint16_t> slots;
    slots.reserve(4 * corners.items.size());
    for (Index node = 0; node < mesh.num_nodes(); ++node) {
        const auto row = pattern.items.begin() + pattern.offsets[node];
        const auto end = pattern.items.begin() + pattern.offsets[node + 1];
        if (end - row > 65535)
            throw Error(ErrorCode::unsupported,
                        fmt::format("Node {} has {} neighbours, the OpenCL back end allows 65535: "
                                    "check the mesh or use the matrix-free product.",
                                    node, end - row));
        for (Index k = corners.offsets[node]; k < corners.offsets[node + 1]; ++k)
            for (Index other : mesh.tets[corners.items[k] / 4])
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

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/model_tables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr Index nodes_per_thread = 500;

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
    std::vector<std::uint16_t> slots(4 * corners.items.size());
    parallel_ranges(mesh.num_nodes(), nodes_per_thread, [&](Index first, Index last) {
        for (Index node = first; node < last; ++node) {
            const Index* row = pattern.items.data() + pattern.offsets[node];
            const Index length = pattern.offsets[node + 1] - pattern.offsets[node];
            if (length > 65535)
                throw Error(
                    ErrorCode::unsupported,
                    fmt::format("Node {} has {} neighbours, the OpenCL back end allows 65535: "
                                "check the mesh or use the matrix-free product.",
                                node, length));
            for (Index k = corners.offsets[node]; k < corners.offsets[node + 1]; ++k)
                for (int b = 0; b < 4; ++b)
                    slots[4 * static_cast<std::size_t>(k) + b] = static_cast<std::uint16_t>(
                        std::find(row, row + length, mesh.tets[corners.items[k] / 4][b]) - row);
        }
    });
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

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/mesh/node_elements.hpp"

#include <algorithm>

#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr Index nodes_per_piece = 2048;  ///< of work that one thread takes at a time

}  // namespace

Adjacency corners_of_nodes(const Mesh& mesh) {
    Adjacency corners;
    corners.offsets.assign(mesh.num_nodes() + 1, 0);
    for (const Tet& tet : mesh.tets)
        for (Index node : tet) ++corners.offsets[node + 1];
    for (Index n = 0; n < mesh.num_nodes(); ++n) corners.offsets[n + 1] += corners.offsets[n];

    corners.items.resize(4 * mesh.tets.size());
    std::vector<Index> next(corners.offsets.begin(), corners.offsets.end() - 1);
    for (Index t = 0; t < mesh.num_tets(); ++t)
        for (Index a = 0; a < 4; ++a) corners.items[next[mesh.tets[t][a]]++] = 4 * t + a;
    return corners;
}

Adjacency node_graph(const Mesh& mesh) {
    const Adjacency corners = corners_of_nodes(mesh);
    const Index num_nodes = mesh.num_nodes();
    const Index num_pieces = (num_nodes + nodes_per_piece - 1) / nodes_per_piece;
    Adjacency graph;
    graph.offsets.assign(num_nodes + 1, 0);
    std::vector<std::vector<Index>> pieces(num_pieces);
    parallel_ranges(num_pieces, 1, [&](Index first, Index last) {
        std::vector<Index> seen_by(num_nodes, -1);
        for (Index piece = first; piece < last; ++piece) {
            std::vector<Index>& items = pieces[piece];
            const Index end = std::min(num_nodes, (piece + 1) * nodes_per_piece);
            for (Index n = piece * nodes_per_piece; n < end; ++n) {
                const std::size_t begin = items.size();
                seen_by[n] = n;
                items.push_back(n);
                for (Index k = corners.offsets[n]; k < corners.offsets[n + 1]; ++k)
                    for (Index node : mesh.tets[corners.items[k] / 4])
                        if (seen_by[node] != n) {
                            seen_by[node] = n;
                            items.push_back(node);
                        }
                std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin), items.end());
                graph.offsets[n + 1] = static_cast<Index>(items.size() - begin);
            }
        }
    });
    for (Index n = 0; n < num_nodes; ++n) graph.offsets[n + 1] += graph.offsets[n];
    graph.items.reserve(graph.offsets.back());
    for (const std::vector<Index>& piece : pieces)
        graph.items.insert(graph.items.end(), piece.begin(), piece.end());
    return graph;
}

}  // namespace palpate

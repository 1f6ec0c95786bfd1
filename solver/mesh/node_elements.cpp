// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/mesh/node_elements.hpp"

#include <algorithm>

namespace palpate {

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
    Adjacency graph;
    graph.offsets.assign(1, 0);
    graph.offsets.reserve(mesh.nodes.size() + 1);
    std::vector<Index> row;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        row.assign(1, n);
        for (Index k = corners.offsets[n]; k < corners.offsets[n + 1]; ++k)
            for (Index node : mesh.tets[corners.items[k] / 4]) row.push_back(node);
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
        graph.items.insert(graph.items.end(), row.begin(), row.end());
        graph.offsets.push_back(static_cast<Index>(graph.items.size()));
    }
    return graph;
}

}  // namespace palpate

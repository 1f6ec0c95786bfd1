// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/element_parts.hpp"

#include <algorithm>

#include "solver/mesh/spatial_order.hpp"

namespace palpate {
namespace {

/// A part of 128 linear tetrahedra has some 50 nodes and 400 blocks of the stiffness: 30 KB.
constexpr Index fewest_elements = 32, most_elements = 128;
/// So many parts that every colour has some for all cores.
constexpr Index wanted_parts = 128;

std::vector<Vec3> centroids_of(const SolidMesh& mesh) {
    std::vector<Vec3> centroids;
    centroids.reserve(mesh.region.size());
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        Vec3 sum = Vec3::Zero();
        for (const Index node : mesh.nodes_of(e)) sum += mesh.nodes[node];
        centroids.push_back(sum / mesh.table().num_nodes);
    }
    return centroids;
}

/// The parts that have a node.
std::vector<std::vector<Index>> parts_of_nodes(const SolidMesh& mesh, const Adjacency& elements) {
    std::vector<std::vector<Index>> parts(mesh.nodes.size());
    for (Index p = 0; p < elements.num_lists(); ++p)
        for (Index k = elements.offsets[p]; k < elements.offsets[p + 1]; ++k)
            for (const Index node : mesh.nodes_of(elements.items[k]))
                if (parts[node].empty() || parts[node].back() != p) parts[node].push_back(p);
    return parts;
}

/// Every part gets the first colour that no part before it with a node in common has.
std::vector<std::vector<Index>> coloured(const SolidMesh& mesh, const Adjacency& elements) {
    const std::vector<std::vector<Index>> around = parts_of_nodes(mesh, elements);
    std::vector<Index> colour(elements.num_lists(), -1);
    std::vector<Index> taken;  // by which part a colour was last seen near another one
    std::vector<std::vector<Index>> lists;
    for (Index p = 0; p < elements.num_lists(); ++p) {
        for (Index k = elements.offsets[p]; k < elements.offsets[p + 1]; ++k)
            for (const Index node : mesh.nodes_of(elements.items[k]))
                for (const Index other : around[node])
                    if (colour[other] >= 0) taken[colour[other]] = p;
        const auto free = std::find_if(taken.begin(), taken.end(), [&](Index t) { return t != p; });
        colour[p] = static_cast<Index>(free - taken.begin());
        if (free == taken.end()) {
            taken.push_back(-1);
            lists.emplace_back();
        }
        lists[colour[p]].push_back(p);
    }
    return lists;
}

}  // namespace

ElementParts element_parts(const SolidMesh& mesh) {
    ElementParts result;
    result.elements.items = spatial_order(centroids_of(mesh));
    const Index count = mesh.num_elements();
    const Index size = std::clamp(count / wanted_parts, fewest_elements, most_elements);
    for (Index first = 0; first < count; first += size) result.elements.offsets.push_back(first);
    result.elements.offsets.push_back(count);
    result.parts.offsets.push_back(0);
    for (const std::vector<Index>& list : coloured(mesh, result.elements)) {
        result.parts.items.insert(result.parts.items.end(), list.begin(), list.end());
        result.parts.offsets.push_back(static_cast<Index>(result.parts.items.size()));
    }
    return result;
}

}  // namespace palpate

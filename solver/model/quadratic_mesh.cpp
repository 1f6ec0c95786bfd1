// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/quadratic_mesh.hpp"

#include <algorithm>
#include <map>

#include "solver/base/error.hpp"
#include "solver/elements/tet10.hpp"
#include "solver/elements/tri6.hpp"

namespace palpate {
namespace {

struct Quadratic {
    ElementType type;
    std::span<const std::array<int, 2>> edges;
};

Quadratic quadratic_of(const SolidMesh& linear) {
    if (linear.type == ElementType::tet4) return {ElementType::tet10, tet10_edges};
    if (linear.type == ElementType::tri3) return {ElementType::tri6, tri6_edges};
    throw Error(ErrorCode::invalid_argument, "elements of type " + linear.table().name +
                                                 " cannot be made quadratic; allowed: tet4, tri3");
}

}  // namespace

SolidMesh with_edge_nodes(const SolidMesh& linear) {
    const Quadratic quadratic = quadratic_of(linear);
    SolidMesh mesh = linear;
    mesh.type = quadratic.type;
    mesh.elements.clear();
    std::map<std::pair<Index, Index>, Index> middles;
    for (Index e = 0; e < linear.num_elements(); ++e) {
        const auto corners = linear.nodes_of(e);
        mesh.elements.insert(mesh.elements.end(), corners.begin(), corners.end());
        for (const auto& [p, q] : quadratic.edges) {
            const auto edge = std::minmax(corners[p], corners[q]);
            const auto [place, is_new] = middles.try_emplace(edge, mesh.num_nodes());
            if (is_new)
                mesh.nodes.push_back(0.5 * (mesh.nodes[edge.first] + mesh.nodes[edge.second]));
            mesh.elements.push_back(place->second);
        }
    }
    return mesh;
}

}  // namespace palpate

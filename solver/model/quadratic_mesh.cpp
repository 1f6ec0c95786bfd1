// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/quadratic_mesh.hpp"

#include <algorithm>
#include <map>
#include <span>

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

constexpr Tet corner_piece[] = {{0, 1, 2, 3}};
/// At the corners; then round the diagonal from the middle of edge 0 1 to that of edge 2 3.
constexpr Tet tet10_pieces[] = {{0, 4, 6, 7}, {1, 5, 4, 8}, {2, 6, 5, 9}, {3, 7, 9, 8},
                                {4, 9, 5, 6}, {4, 9, 6, 7}, {4, 9, 7, 8}, {4, 9, 8, 5}};

void require_tetrahedra(const SolidMesh& mesh) {
    if (mesh.type == ElementType::tet4 || mesh.type == ElementType::tet10) return;
    throw Error(ErrorCode::invalid_argument,
                "elements of type " + mesh.table().name + " are no tetrahedra");
}

Mesh pieces_of(const SolidMesh& mesh, std::span<const Tet> pieces) {
    Mesh linear;
    linear.nodes = mesh.nodes;
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        const auto nodes = mesh.nodes_of(e);
        for (const Tet& piece : pieces) {
            linear.tets.push_back(
                {nodes[piece[0]], nodes[piece[1]], nodes[piece[2]], nodes[piece[3]]});
            linear.region.push_back(mesh.region[e]);
        }
    }
    return linear;
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

Mesh linear_mesh_of(const SolidMesh& mesh) {
    require_tetrahedra(mesh);
    return mesh.type == ElementType::tet4 ? pieces_of(mesh, corner_piece)
                                          : pieces_of(mesh, tet10_pieces);
}

Mesh corner_mesh_of(const SolidMesh& mesh) {
    require_tetrahedra(mesh);
    return pieces_of(mesh, corner_piece);
}

}  // namespace palpate

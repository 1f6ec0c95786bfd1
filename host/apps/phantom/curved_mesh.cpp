// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/curved_mesh.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

constexpr int newton_steps = 4;
constexpr double least_volume = 1.0 / 3;  ///< of a linear piece, of what it was

using RegionPair = std::array<Index, 2>;

std::vector<std::uint8_t> mid_side_nodes(const SolidMesh& mesh) {
    std::vector<std::uint8_t> found(mesh.nodes.size(), 0);
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (std::size_t k = 4; k < mesh.nodes_of(e).size(); ++k) found[mesh.nodes_of(e)[k]] = 1;
    return found;
}

/// The regions that meet at each mid-side node of one interface.
std::map<Index, RegionPair> interface_nodes(const BodyMesh& body, const LabelField& field) {
    const auto is_middle = mid_side_nodes(body.mesh);
    std::map<Index, RegionPair> regions;
    std::set<Index> left_alone;
    for (Index t = 0; t < body.surface.num_triangles(); ++t) {
        RegionPair pair{body.surface.regions[t][0], body.surface.regions[t][1]};
        std::sort(pair.begin(), pair.end());
        const bool is_interface =
            pair[0] != outside_region && field.has_region(pair[0]) && field.has_region(pair[1]);
        for (const Index node : body.surface.triangles[t]) {
            if (!is_middle[node]) continue;
            const auto [place, is_new] = regions.try_emplace(node, pair);
            if (!is_interface || place->second != pair) left_alone.insert(node);
        }
    }
    for (const Index node : left_alone) regions.erase(node);
    return regions;
}

Vec3 on_interface(const LabelField& field, const RegionPair& regions, Vec3 x) {
    for (int k = 0; k < newton_steps; ++k) {
        Vec3 gradient;
        const double value = field.interface_value(regions[0], regions[1], x, &gradient);
        if (!(gradient.squaredNorm() > 0)) break;
        x -= value / gradient.squaredNorm() * gradient;
    }
    return x;
}

}  // namespace

BodyMesh curved_along(const LabelField& field, BodyMesh body) {
    if (body.mesh.type != ElementType::tet10) return body;
    const Mesh straight = linear_mesh_of(body.mesh);
    Mesh curved = straight;
    for (const auto& [node, regions] : interface_nodes(body, field))
        curved.nodes[node] = on_interface(field, regions, straight.nodes[node]);
    for (bool is_sound = false; !is_sound;) {
        is_sound = true;
        for (Index t = 0; t < straight.num_tets(); ++t) {
            if (tet_volume(curved, t) >= least_volume * tet_volume(straight, t)) continue;
            for (const Index node : body.mesh.nodes_of(t / pieces_of_tet10)) {
                is_sound = is_sound && curved.nodes[node] == straight.nodes[node];
                curved.nodes[node] = straight.nodes[node];
            }
        }
    }
    body.mesh.nodes = curved.nodes;
    body.surface.vertices = curved.nodes;
    return body;
}

}  // namespace palpate

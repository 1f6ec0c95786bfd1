// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/modelling/regions.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// The faces of a positively oriented tet, counter-clockwise seen from outside.
constexpr int tet_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

struct TetFace {
    Triangle nodes{};  ///< as seen from the first tet
    Index back = -1;   ///< region of the first tet
    Index front = -1;  ///< region of the second tet, -1: none
};

std::map<Triangle, TetFace> faces_of(const Mesh& mesh) {
    std::map<Triangle, TetFace> faces;
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        for (const auto& corner : tet_faces) {
            const Triangle nodes{mesh.tets[t][corner[0]], mesh.tets[t][corner[1]],
                                 mesh.tets[t][corner[2]]};
            Triangle key = nodes;
            std::sort(key.begin(), key.end());
            auto [place, is_new] = faces.try_emplace(key, TetFace{nodes, mesh.region[t], -1});
            if (!is_new) place->second.front = mesh.region[t];
        }
    }
    return faces;
}

/// What lies beyond a boundary face: the hollow organ there, else the outside.
Index region_beyond(const LabelField& field, const std::vector<Index>& hollow, const Vec3& centre,
                    const Vec3& outward, double edge) {
    for (const double distance : {0.25 * edge, 0.5 * edge, edge}) {
        const Vec3 point = centre + distance * outward;
        if (!field.inside_box(point)) return outside_region;
        const Index region = field.region_at(point);
        if (std::find(hollow.begin(), hollow.end(), region) != hollow.end()) return region;
    }
    // A sharp end of the tissue between organs, past which those points lie: the closest organ.
    Index beyond = outside_region;
    double closest = edge;
    for (const Index region : hollow) {
        if (!field.has_region(region)) continue;
        const double distance = std::abs(field.value(region, centre));
        if (distance > closest) continue;
        closest = distance;
        beyond = region;
    }
    return beyond;
}

/// `mesh` restricted to the tets with a positive region, unused nodes dropped.
Mesh without_outside(const Mesh& mesh) {
    Mesh kept;
    std::vector<Index> number(mesh.nodes.size(), -1);
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        if (mesh.region[t] == outside_region) continue;
        Tet tet = mesh.tets[t];
        for (Index& node : tet) {
            if (number[node] < 0) {
                number[node] = kept.num_nodes();
                kept.nodes.push_back(mesh.nodes[node]);
            }
            node = number[node];
        }
        kept.tets.push_back(tet);
        kept.region.push_back(mesh.region[t]);
    }
    return kept;
}

}  // namespace

Mesh with_region_numbers(const Mesh& labelled, const Settings& settings,
                         const std::string& mesh_name) {
    Mesh mesh = labelled;
    std::vector<Index> tets(settings.num_regions(), 0);
    const bool rest_is_background = settings.background && !settings.background->label;
    for (Index& region : mesh.region) {
        const Index label = region;
        region = rest_is_background ? background_region : outside_region;
        if (settings.background && settings.background->label == label) region = background_region;
        for (std::size_t k = 0; k < settings.organs.size(); ++k) {
            if (settings.organs[k].label != label) continue;
            region = settings.organs[k].hollow ? outside_region
                                               : first_organ_region + static_cast<Index>(k);
        }
        ++tets[region];
    }
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (settings.organs[k].hollow || tets[first_organ_region + k] > 0) continue;
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: no element has the label {} of organ '{}'; the cell array "
                                "'region' must hold the labels of the settings",
                                mesh_name, settings.organs[k].label, settings.organs[k].name));
    }
    return without_outside(mesh);
}

RegionMesh region_mesh_from_tets(const Mesh& mesh, const LabelField& field,
                                 const Settings& settings) {
    const auto hollow = hollow_regions(settings);
    RegionMesh result{mesh, {}};
    result.surface.vertices = mesh.nodes;
    for (const auto& [key, face] : faces_of(mesh)) {
        if (face.front == face.back) continue;
        const Vec3& p0 = mesh.nodes[face.nodes[0]];
        const Vec3 cross = (mesh.nodes[face.nodes[1]] - p0).cross(mesh.nodes[face.nodes[2]] - p0);
        const Vec3 centre = (p0 + mesh.nodes[face.nodes[1]] + mesh.nodes[face.nodes[2]]) / 3.0;
        const double edge = std::sqrt(cross.norm());
        Index front = face.front;
        bool border = false;
        if (front < 0) {
            front = region_beyond(field, hollow, centre, cross.normalized(), edge);
            border = front == outside_region &&
                     !field.inside_box(centre + 0.1 * edge * cross.normalized());
        }
        result.surface.triangles.push_back(face.nodes);
        result.surface.regions.push_back({face.back, front});
        result.surface.on_image_border.push_back(border);
    }
    return result;
}

}  // namespace palpate

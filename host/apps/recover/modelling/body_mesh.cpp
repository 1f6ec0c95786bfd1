// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/body_mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "host/apps/recover/modelling/regions.hpp"
#include "solver/base/error.hpp"
#include "solver/elements/tet10.hpp"
#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

struct ElementFace {
    Triangle corners{};  ///< as seen from the first element
    Index back = -1;     ///< region of the first element
    Index front = -1;    ///< region of the second, -1: none
};

std::map<Triangle, ElementFace> faces_of(const SolidMesh& mesh) {
    std::map<Triangle, ElementFace> faces;
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        const auto nodes = mesh.nodes_of(e);
        for (const auto& face : mesh.table().faces) {
            const Triangle corners{nodes[face[0]], nodes[face[1]], nodes[face[2]]};
            Triangle key = corners;
            std::sort(key.begin(), key.end());
            auto [place, is_new] = faces.try_emplace(key, ElementFace{corners, mesh.region[e], -1});
            if (!is_new) place->second.front = mesh.region[e];
        }
    }
    return faces;
}

using Edge = std::pair<Index, Index>;  ///< smaller node first

Edge edge_of(Index a, Index b) { return std::minmax(a, b); }

/// The mid-side node of every edge; none of linear elements.
std::map<Edge, Index> mid_side_nodes(const SolidMesh& mesh) {
    std::map<Edge, Index> middle;
    if (mesh.type != ElementType::tet10) return middle;
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        const auto nodes = mesh.nodes_of(e);
        for (std::size_t k = 0; k < tet10_edges.size(); ++k)
            middle[edge_of(nodes[tet10_edges[k][0]], nodes[tet10_edges[k][1]])] = nodes[4 + k];
    }
    return middle;
}

/// The same surface through the mid-side nodes of `mesh`: four triangles in the place of one. A
/// triangle without elements on both sides (between hollow organs, or at the image box) stays
/// whole.
///            2
///         20   12
///       0    01    1
RegionSurface through_mid_sides(const RegionSurface& corners, const SolidMesh& mesh) {
    const auto middle = mid_side_nodes(mesh);
    RegionSurface surface;
    surface.vertices = mesh.nodes;
    for (Index t = 0; t < corners.num_triangles(); ++t) {
        const auto& [p, q, r] = corners.triangles[t];
        const auto pq = middle.find(edge_of(p, q)), qr = middle.find(edge_of(q, r)),
                   rp = middle.find(edge_of(r, p)), none = middle.end();
        std::vector<Triangle> parts{corners.triangles[t]};
        if (pq != none && qr != none && rp != none)
            parts = {{p, pq->second, rp->second},
                     {pq->second, q, qr->second},
                     {rp->second, qr->second, r},
                     {pq->second, qr->second, rp->second}};
        surface.triangles.insert(surface.triangles.end(), parts.begin(), parts.end());
        surface.regions.insert(surface.regions.end(), parts.size(), corners.regions[t]);
        surface.on_image_border.insert(surface.on_image_border.end(), parts.size(),
                                       corners.on_image_border[t]);
    }
    return surface;
}

BodyMesh with_mid_sides(BodyMesh body) {
    if (body.mesh.type == ElementType::tet10)
        body.surface = through_mid_sides(body.surface, body.mesh);
    return body;
}

SolidMesh as_element(SolidMesh mesh, ElementType element) {
    if (element != ElementType::tet4 && element != ElementType::tet10)
        throw Error(ErrorCode::invalid_argument,
                    "recover takes tet4 and tet10, not " + element_table(element).name);
    return mesh.type == ElementType::tet4 && element == ElementType::tet10 ? with_edge_nodes(mesh)
                                                                           : mesh;
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

/// `mesh` restricted to the elements with a positive region, unused nodes dropped.
SolidMesh without_outside(const SolidMesh& mesh) {
    SolidMesh kept;
    kept.type = mesh.type;
    std::vector<Index> number(mesh.nodes.size(), -1);
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        if (mesh.region[e] == outside_region) continue;
        for (const Index node : mesh.nodes_of(e)) {
            if (number[node] < 0) {
                number[node] = kept.num_nodes();
                kept.nodes.push_back(mesh.nodes[node]);
            }
            kept.elements.push_back(number[node]);
        }
        kept.region.push_back(mesh.region[e]);
    }
    return kept;
}

}  // namespace

SolidMesh with_region_numbers(SolidMesh mesh, const Settings& settings,
                              const std::string& mesh_name) {
    std::vector<Index> elements(settings.num_regions(), 0);
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
        ++elements[region];
    }
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (settings.organs[k].hollow || elements[first_organ_region + k] > 0) continue;
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: no element has the label {} of organ '{}'; the cell array "
                                "'region' must hold the labels of the settings",
                                mesh_name, settings.organs[k].label, settings.organs[k].name));
    }
    SolidMesh kept = without_outside(mesh);
    try {
        point_geometry(kept);
    } catch (const Error& error) {
        throw Error(ErrorCode::input_unusable, mesh_name + ": " + error.what());
    }
    return kept;
}

BodyMesh body_mesh(const RegionMesh& mesh, ElementType element) {
    return with_mid_sides({as_element(solid_mesh_of(mesh.mesh), element), mesh.surface});
}

BodyMesh with_mid_side_nodes(const BodyMesh& body) {
    return with_mid_sides({with_edge_nodes(body.mesh), body.surface});
}

BodyMesh body_mesh(SolidMesh given, const LabelField& field, const Settings& settings,
                   ElementType element) {
    const auto hollow = hollow_regions(settings);
    BodyMesh result{as_element(std::move(given), element), {}};
    const SolidMesh& mesh = result.mesh;
    result.surface.vertices = mesh.nodes;
    for (const auto& [key, face] : faces_of(mesh)) {
        if (face.front == face.back) continue;
        const Vec3& p0 = mesh.nodes[face.corners[0]];
        const Vec3 cross =
            (mesh.nodes[face.corners[1]] - p0).cross(mesh.nodes[face.corners[2]] - p0);
        const Vec3 centre = (p0 + mesh.nodes[face.corners[1]] + mesh.nodes[face.corners[2]]) / 3.0;
        const double edge = std::sqrt(cross.norm());
        Index front = face.front;
        bool border = false;
        if (front < 0) {
            front = region_beyond(field, hollow, centre, cross.normalized(), edge);
            border = front == outside_region &&
                     !field.inside_box(centre + 0.1 * edge * cross.normalized());
        }
        result.surface.triangles.push_back(face.corners);
        result.surface.regions.push_back({face.back, front});
        result.surface.on_image_border.push_back(border);
    }
    return with_mid_sides(std::move(result));
}

ElementType recovery_element_of(const std::string& name) {
    for (const ElementType type : {ElementType::tet4, ElementType::tet10})
        if (name == element_table(type).name) return type;
    throw Error(ErrorCode::invalid_argument,
                "recover has no element '" + name + "'; choose tet4 or tet10");
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/viewer_data.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/apps/recover/report/findings.hpp"
#include "host/page/markup.hpp"
#include "host/page/packing.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

std::string packed(const std::vector<Vec3>& points) {
    std::vector<double> values;
    values.reserve(3 * points.size());
    for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
    return pack_floats(values);
}

std::string packed(const std::vector<Triangle>& triangles) {
    std::vector<std::uint32_t> values;
    values.reserve(3 * triangles.size());
    for (const Triangle& t : triangles)
        for (Index v : t) values.push_back(static_cast<std::uint32_t>(v));
    return pack_indices(values);
}

/// A value of the mesh at each vertex of an organ surface; `missing` where there is no node.
template <typename T>
std::vector<T> at_vertices(const SurfaceResult& s, const std::vector<T>& nodal, const T& missing) {
    std::vector<T> values(s.reference.vertices.size(), missing);
    for (std::size_t v = 0; v < values.size() && v < s.node_of.size(); ++v) {
        const Index node = s.node_of[v];
        if (node >= 0 && static_cast<std::size_t>(node) < nodal.size()) values[v] = nodal[node];
    }
    return values;
}

/// |nodal force| over a third of the area round the vertex: mN / mm^2 = kPa.
std::vector<double> traction_kpa(const SurfaceResult& s, const std::vector<Vec3>& force) {
    std::vector<double> area(s.reference.vertices.size(), 0.0);
    for (const Triangle& t : s.reference.triangles) {
        const Vec3& a = s.reference.vertices[t[0]];
        const Vec3 ab = s.reference.vertices[t[1]] - a, ac = s.reference.vertices[t[2]] - a;
        for (Index v : t) area[v] += ab.cross(ac).norm() / 6;
    }
    const std::vector<Vec3> forces = at_vertices(s, force, Vec3(Vec3::Zero()));
    std::vector<double> traction(area.size(), 0.0);
    for (std::size_t v = 0; v < area.size(); ++v)
        if (area[v] > 0) traction[v] = forces[v].norm() / area[v];
    return traction;
}

/// A distance at each vertex of an organ surface; what the viewer knows as unseen elsewhere.
std::vector<double> seen_distances(const SurfaceResult& s, std::vector<double> distance_mm) {
    constexpr double unseen = 1e4;  // as in surface_viewer.js
    distance_mm.resize(s.reference.vertices.size(), 0.0);
    for (std::size_t v = 0; v < std::min(s.seen.size(), distance_mm.size()); ++v)
        if (!s.seen[v]) distance_mm[v] = unseen;
    return distance_mm;
}

Json surface_json(const RecoveryResult& result, const SurfaceResult& s) {
    const std::vector<double> before = seen_distances(s, s.distance_before_mm),
                              after = seen_distances(s, s.distance_after_mm);
    return {{"name", s.name},
            {"role", name_of(s.role)},
            {"colour", region_colour(result, s.region)},
            {"vertices", packed(s.reference.vertices)},
            {"displacement", packed(at_vertices(s, result.displacement, Vec3(Vec3::Zero())))},
            {"triangles", packed(s.reference.triangles)},
            {"distance_before_mm", pack_floats(before)},
            {"distance_after_mm", pack_floats(after)},
            {"traction_kpa", pack_floats(traction_kpa(s, result.force))},
            {"target_vertices", packed(s.target.vertices)},
            {"target_triangles", packed(s.target.triangles)}};
}

Json volumes_json(const RecoveryResult& result, const LabelVolumes& volumes) {
    if (volumes.empty()) return nullptr;
    Json organs = Json::array();
    for (Index region : volumes.regions)
        organs.push_back(
            {{"name", region_name(result, region)}, {"colour", region_colour(result, region)}});
    const auto list = [](const Vec3& v) { return Json{v[0], v[1], v[2]}; };
    // The volumes lie in the target's frame, the surfaces in the reference's.
    const RigidTransform back = result.alignment.reference_to_target.inverse();
    const Mat3 axes = back.rotation * volumes.axes;
    return {{"size", volumes.size},
            {"spacing_mm", list(volumes.spacing)},
            {"origin_mm", list(back.apply(volumes.origin))},
            {"axes", {list(axes.col(0)), list(axes.col(1)), list(axes.col(2))}},
            {"centre", volumes.centre},
            {"organs", organs},
            {"reference", to_base64(run_lengths(volumes.reference))},
            {"target", to_base64(run_lengths(volumes.target))},
            {"warped", to_base64(run_lengths(volumes.warped))}};
}

Json pictures_json(const ShownPictures& pictures) {
    Json json = Json::object();
    const auto add = [&](const char* name, const ShownPicture& picture) {
        if (picture.empty()) return;
        json[name] = {{"size", picture.grey.size},
                      {"tiles_per_row", picture.tiles_per_row},
                      {"png", picture.mosaic}};
    };
    add("target", pictures.target);
    add("reference", pictures.reference);
    return json;
}

/// Inside a <script> element "</script" and "<!--" must not occur; in JSON "<" may be escaped.
std::string safe_in_script(const std::string& json) {
    std::string out;
    out.reserve(json.size());
    for (char c : json) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return out;
}

}  // namespace

std::string viewer_data(const RecoveryResult& result, const LabelVolumes& volumes,
                        const ShownPictures& pictures) {
    Json surfaces = Json::array();
    for (const SurfaceResult& s : result.surfaces) surfaces.push_back(surface_json(result, s));
    const Json json{{"surfaces", surfaces},
                    {"volumes", volumes_json(result, volumes)},
                    {"pictures", pictures_json(pictures)}};
    return safe_in_script(json.dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace palpate

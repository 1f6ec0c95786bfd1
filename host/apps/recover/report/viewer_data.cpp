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

/// A distance at each vertex of an organ surface; not known where the target does not show it.
std::vector<double> seen_distances(const SurfaceResult& s, std::vector<double> distance_mm) {
    distance_mm.resize(s.reference.vertices.size(), 0.0);
    for (std::size_t v = 0; v < std::min(s.seen.size(), distance_mm.size()); ++v)
        if (!s.seen[v]) distance_mm[v] = NAN;
    return distance_mm;
}

enum FieldNumber { distance, displacement, traction, num_fields };

SurfaceInView shown_surface(const RecoveryResult& result, const SurfaceResult& s) {
    SurfaceInView shown{.name = s.name, .colour = region_colour(result, s.region)};
    shown.is_plain = s.role == Role::fixed;
    shown.is_shown = !shown.is_plain;
    shown.shape = {s.reference.vertices, s.reference.triangles};
    shown.displacement = {{}, at_vertices(s, result.displacement, Vec3(Vec3::Zero()))};
    shown.outline = TriangleShape{s.target.vertices, s.target.triangles};
    shown.values.resize(num_fields);
    if (shown.is_plain) return shown;
    shown.values[distance] = {seen_distances(s, s.distance_before_mm),
                              seen_distances(s, s.distance_after_mm)};
    if (s.role == Role::driven) shown.values[traction] = {{}, traction_kpa(s, result.force)};
    return shown;
}

/// The largest over all surfaces of what is below most values of each, but not nothing.
template <class ValuesOf>
double largest_of(const std::vector<SurfaceInView>& surfaces, const ValuesOf& values_of) {
    constexpr double most = 0.97, smallest = 1e-3;
    double largest = smallest;
    for (const SurfaceInView& s : surfaces)
        if (!s.is_plain) largest = std::max(largest, quantile_of_sizes(values_of(s), most));
    return largest;
}

std::vector<double> lengths_of(const std::vector<Vec3>& vectors) {
    std::vector<double> lengths;
    for (const Vec3& v : vectors) lengths.push_back(v.norm());
    return lengths;
}

/// Ends of a colour scale of distances: those of the eye's choice below the largest, and that.
std::vector<double> distance_ranges(double largest) {
    std::vector<double> ranges;
    for (const double mm : {0.5, 1.0, 2.0, 5.0, 10.0})
        if (mm < largest) ranges.push_back(mm);
    ranges.push_back(largest);
    return ranges;
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

}  // namespace

SurfaceView recovery_view(const RecoveryResult& result) {
    SurfaceView view{
        .label = "Organ surfaces before and after",
        .states = {"Before", "After"},
        .first = 1,
        .plain_name = "organ",
        .outline_name = "Target",
        .note = "Left: before, right: at the chosen part of the recovered deformation.",
        .without_webgl = "The slices below show the same outlines.",
        .has_rest_beside = true,
        .is_patient = true,
        .most_triangles = 300000,
    };
    for (const SurfaceResult& s : result.surfaces)
        view.surfaces.push_back(shown_surface(result, s));
    const auto highest = [&](const auto& values_of) {
        return round_ranges(largest_of(view.surfaces, values_of)).back();
    };
    const auto values_in = [](FieldNumber field, std::size_t state) {
        return [=](const SurfaceInView& s) {
            return s.values[field].empty() ? std::vector<double>{} : s.values[field][state];
        };
    };
    const auto moved = [](const SurfaceInView& s) { return lengths_of(s.displacement[1]); };
    view.fields = {{.name = "distance to target",
                    .unit = "mm",
                    .ranges = distance_ranges(highest(values_in(distance, 0))),
                    .is_signed = true,
                    .left = "inside the target",
                    .right = "outside, mm"},
                   {.name = "displacement",
                    .unit = "mm",
                    .ranges = {highest(moved)},
                    .is_displacement = true}};
    const bool has_traction =
        std::any_of(view.surfaces.begin(), view.surfaces.end(),
                    [](const SurfaceInView& s) { return !s.values[traction].empty(); });
    if (has_traction)
        view.fields.push_back({.name = "surface traction",
                               .unit = "kPa",
                               .ranges = {highest(values_in(traction, 1))},
                               .left = "traction on driven organs"});
    return view;
}

std::string viewer_data(const RecoveryResult& result, const LabelVolumes& volumes,
                        const ShownPictures& pictures) {
    const Json json{{"volumes", volumes_json(result, volumes)},
                    {"pictures", pictures_json(pictures)}};
    return script_json(json.dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/surface_view.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/page/assets.hpp"
#include "host/page/derived_shape.hpp"
#include "host/page/markup.hpp"
#include "host/page/packing.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

std::vector<double> numbers_of(const std::vector<Vec3>& points) {
    std::vector<double> values;
    values.reserve(3 * points.size());
    for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
    return values;
}

Json packed(const TriangleShape& shape) {
    std::vector<std::uint32_t> corners;
    corners.reserve(3 * shape.triangles.size());
    for (const Triangle& t : shape.triangles)
        for (const Index v : t) corners.push_back(static_cast<std::uint32_t>(v));
    return {{"vertices", pack_floats(numbers_of(shape.vertices))},
            {"triangles", pack_indices(corners)}};
}

/// Null where there is nothing: 0.
Json scaled(const std::vector<double>& values) {
    if (values.empty()) return nullptr;
    const ScaledNumbers numbers = pack_scaled(values);
    return {{"low", numbers.low}, {"high", numbers.high}, {"packed", numbers.packed}};
}

Json field_json(const ShownField& field) {
    return {{"name", field.name},
            {"unit", field.unit},
            {"ranges", field.ranges},
            {"signed", field.is_signed},
            {"of_displacement", field.is_displacement},
            {"left", field.left.empty() ? field.name : field.left},
            {"right", field.right.empty() ? field.unit : field.right}};
}

Json surface_json(const SurfaceInView& s) {
    Json json{{"name", s.name},      {"colour", s.colour},
              {"shown", s.is_shown}, {"plain", s.is_plain || s.is_glass},
              {"glass", s.is_glass}, {"inside", s.is_inside}};
    json.update(packed(s.shape));
    json["displacement"] = Json::array();
    for (const auto& u : s.displacement) json["displacement"].push_back(scaled(numbers_of(u)));
    json["values"] = Json::array();
    for (const auto& field : s.values) {
        Json states = Json::array();
        for (const auto& values : field) states.push_back(scaled(values));
        json["values"].push_back(field.empty() ? Json() : states);
    }
    json["outline"] = s.outline ? packed(*s.outline) : Json();
    return json;
}

void replace_shape(SurfaceInView& s, const DerivedShape& derived) {
    s.shape = {derived.of(s.shape.vertices), derived.triangles};
    for (auto& u : s.displacement)
        if (!u.empty()) u = derived.of(u);
    for (auto& field : s.values)
        for (auto& values : field)
            if (!values.empty()) values = derived.of(values);
}

std::size_t num_triangles(const std::vector<SurfaceInView>& surfaces) {
    std::size_t count = 0;
    for (const SurfaceInView& s : surfaces) count += s.shape.triangles.size();
    return count;
}

/// Thins all surfaces alike until they have few enough triangles.
void thin(std::vector<SurfaceInView>& surfaces, std::size_t most) {
    const std::size_t all = num_triangles(surfaces);
    if (all <= most) return;
    for (SurfaceInView& s : surfaces)
        replace_shape(s, thinned_to(most * s.shape.triangles.size() / all, s.shape.vertices,
                                    s.shape.triangles));
}

/// Round a surface at rest, or in all its states.
Eigen::AlignedBox3d bounds_of(const SurfaceInView& s, double factor, bool only_rest) {
    Eigen::AlignedBox3d box;
    for (const Vec3& x : s.shape.vertices) box.extend(x);
    if (only_rest) return box;
    for (const auto& u : s.displacement)
        for (std::size_t v = 0; v < u.size(); ++v) box.extend(s.shape.vertices[v] + factor * u[v]);
    return box;
}

/// Round what is seen at first, or where that is nothing round all.
Eigen::AlignedBox3d bounds_of(const SurfaceView& view) {
    Eigen::AlignedBox3d seen, all;
    for (const SurfaceInView& s : view.surfaces) {
        all.extend(bounds_of(s, view.factor, view.has_rest_beside));
        if (s.is_shown && !s.is_glass) seen.extend(bounds_of(s, view.factor, view.has_rest_beside));
    }
    if (!seen.isEmpty()) return seen;
    return all.isEmpty() ? Eigen::AlignedBox3d(Vec3::Zero(), Vec3::Zero()) : all;
}

Json view_json(const SurfaceView& view) {
    const Eigen::AlignedBox3d box = bounds_of(view);
    const Vec3 centre = box.center(), half = box.sizes() / 2;
    Json json{{"label", view.label},
              {"states", view.states},
              {"first", view.first},
              {"fields", Json::array()},
              {"plain", view.plain_name},
              {"outline", view.outline_name},
              {"without_webgl", view.without_webgl},
              {"beside", view.has_rest_beside},
              {"patient", view.is_patient},
              {"creased", view.has_creases},
              {"azimuth", view.azimuth},
              {"elevation", view.elevation},
              {"factor", view.factor},
              {"centre_mm", {centre.x(), centre.y(), centre.z()}},
              {"half_mm", {half.x(), half.y(), half.z()}},
              {"radius_mm", std::max(half.norm(), 1e-3)},
              {"surfaces", Json::array()}};
    for (const ShownField& field : view.fields) json["fields"].push_back(field_json(field));
    for (const SurfaceInView& s : view.surfaces) json["surfaces"].push_back(surface_json(s));
    return json;
}

}  // namespace

std::vector<double> round_ranges(double largest) {
    if (!(largest > 0) || !std::isfinite(largest)) return {1};
    const double power = std::pow(10, std::floor(std::log10(largest)));
    const auto rounded = [](double value) { return std::stod(fmt::format("{:.3g}", value)); };
    double high = 10 * power;
    for (const double step : {8.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.0})
        if (step * power >= 0.999 * largest) high = step * power;
    std::vector<double> ranges;
    for (const double part : {0.1, 0.2, 0.5, 1.0}) ranges.push_back(rounded(part * high));
    return ranges;
}

double quantile_of_sizes(std::vector<double> values, double part) {
    std::erase_if(values, [](double value) { return std::isnan(value); });
    if (values.empty()) return 0;
    for (double& value : values) value = std::abs(value);
    const std::size_t at =
        std::min(values.size() - 1, static_cast<std::size_t>(part * double(values.size())));
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at),
                     values.end());
    return values[at];
}

std::string surface_viewer_html(const SurfaceView& wanted) {
    if (wanted.surfaces.empty()) return "";
    SurfaceView view = wanted;
    thin(view.surfaces, view.most_triangles);
    const std::size_t all = num_triangles(wanted.surfaces), kept = num_triangles(view.surfaces);
    if (view.has_creases)
        for (SurfaceInView& s : view.surfaces)
            replace_shape(s, split_at_creases(s.shape.vertices, s.shape.triangles));
    const std::string thinned_note =
        kept == all ? ""
                    : fmt::format(
                          "To keep this page small the surfaces are thinned, from {} to {} "
                          "triangles. ",
                          all, kept);
    return fmt::format(
        "<div class='surface-viewer needs-script{}'><p class='caption'>{} {}<span "
        "class='screen-only'>Drag to turn, wheel or pinch to zoom, shift-drag to move, double "
        "click to reset.</span></p><script type='application/json'>{}</script></div>",
        view.has_static ? " screen-only" : "", view.note, thinned_note,
        script_json(view_json(view).dump(-1, ' ', true, Json::error_handler_t::replace)));
}

std::string surface_viewer_script() {
    std::string script;
    for (const std::string_view part : {page_parts_js(), surface_data_js(), surface_camera_js(),
                                        surface_renderer_js(), surface_viewer_js()})
        script += part;
    return script;
}

}  // namespace palpate

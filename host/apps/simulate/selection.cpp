// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/apps/simulate/setting_values.hpp"
#include "solver/model/surface_load.hpp"

namespace palpate {
namespace {

constexpr double default_tolerance = 1e-6;  ///< of the diagonal of the mesh

struct Extent {
    Vec3 low, high;
    double diagonal() const { return (high - low).norm(); }
};

Extent extent_of(const SolidMesh& mesh) {
    Extent extent{mesh.nodes.front(), mesh.nodes.front()};
    for (const Vec3& place : mesh.nodes) {
        extent.low = extent.low.cwiseMin(place);
        extent.high = extent.high.cwiseMax(place);
    }
    return extent;
}

std::string text_of(const Vec3& place) {
    return fmt::format("({:g}, {:g}, {:g})", place.x(), place.y(), place.z());
}

/// The place criteria of a selection for one mesh.
class PlaceFilter {
public:
    PlaceFilter(const Selection& selection, const SolidMesh& mesh)
        : selection_(selection),
          extent_(extent_of(mesh)),
          tolerance_(selection.tolerance_mm.value_or(default_tolerance * extent_.diagonal())) {}

    bool takes(const Vec3& place) const {
        return is_on_side(place) && is_in_box(place) && is_in_ball(place) && is_in_plane(place);
    }
    const Extent& extent() const { return extent_; }

private:
    bool is_on_side(const Vec3& place) const {
        if (!selection_.side) return true;
        const int axis = selection_.side->front() - 'x';
        const bool is_low = selection_.side->ends_with("min");
        const double end = is_low ? extent_.low[axis] : extent_.high[axis];
        return std::abs(place[axis] - end) <= tolerance_;
    }
    bool is_in_box(const Vec3& place) const {
        const auto& from = selection_.from_mm;
        const auto& to = selection_.to_mm;
        return (!from || (place.array() >= from->array() - tolerance_).all()) &&
               (!to || (place.array() <= to->array() + tolerance_).all());
    }
    bool is_in_ball(const Vec3& place) const {
        return !selection_.centre_mm ||
               (place - *selection_.centre_mm).norm() <= selection_.radius_mm + tolerance_;
    }
    bool is_in_plane(const Vec3& place) const {
        return !selection_.point_mm ||
               std::abs((place - *selection_.point_mm).dot(selection_.normal.normalized())) <=
                   tolerance_;
    }

    const Selection& selection_;
    Extent extent_;
    double tolerance_;
};

const std::vector<double>* array_of(const Selection& selection, const SelectableMesh& in) {
    if (!selection.point_array) return nullptr;
    const auto found = in.point_scalars.find(*selection.point_array);
    if (found != in.point_scalars.end()) return &found->second;
    std::string names;
    for (const auto& [name, values] : in.point_scalars) names += (names.empty() ? "" : ", ") + name;
    selection.source.refuse("point_array", names.empty()
                                               ? "the mesh has no point arrays of one component"
                                               : "allowed, because the mesh has them: " + names);
}

[[noreturn]] void refuse_empty(const Selection& selection, const std::string& what,
                               const Extent& extent) {
    selection.source.fail(fmt::format(
        "no {} of the mesh is selected; the mesh reaches from {} to {} mm, so mend the numbers or "
        "give a larger tolerance_mm",
        what, text_of(extent.low), text_of(extent.high)));
}

}  // namespace

Selection read_selection(const SettingsTable& table) {
    table.allow_keys({"side", "from_mm", "to_mm", "centre_mm", "radius_mm", "point_mm", "normal",
                      "point_array", "value", "tolerance_mm"});
    Selection selection;
    selection.source = table;
    selection.side = table.choice("side", {"x-min", "x-max", "y-min", "y-max", "z-min", "z-max"});
    selection.from_mm = vector_of(table, "from_mm");
    selection.to_mm = vector_of(table, "to_mm");
    selection.centre_mm = vector_of(table, "centre_mm");
    if (selection.centre_mm) selection.radius_mm = needed_number(table, "radius_mm", positive);
    selection.point_mm = vector_of(table, "point_mm");
    if (const auto normal = vector_of(table, "normal")) selection.normal = *normal;
    if (selection.point_mm && !table.has("normal")) table.missing("normal", "of the plane");
    if (!(selection.normal.norm() > 0)) table.refuse("normal", "allowed: a direction, not zero");
    selection.point_array = table.text("point_array");
    selection.value = table.number("value", any_number);
    selection.tolerance_mm = table.number("tolerance_mm", positive);
    const auto belongs = [&](const char* key, const char* to) {
        if (table.has(key) && !table.has(to))
            table.refuse(key, fmt::format("allowed only together with {}", to));
    };
    belongs("radius_mm", "centre_mm");
    belongs("normal", "point_mm");
    belongs("value", "point_array");
    return selection;
}

std::vector<std::uint8_t> selected_nodes(const Selection& selection, const SelectableMesh& in) {
    const PlaceFilter filter(selection, in.mesh);
    const std::vector<double>* array = array_of(selection, in);
    std::vector<std::uint8_t> is_selected(in.mesh.nodes.size(), 0);
    for (std::size_t n = 0; n < is_selected.size(); ++n) {
        const bool array_agrees =
            !array || (selection.value ? (*array)[n] == *selection.value : (*array)[n] != 0);
        is_selected[n] = array_agrees && filter.takes(in.mesh.nodes[n]);
    }
    if (std::count(is_selected.begin(), is_selected.end(), 1) == 0)
        refuse_empty(selection, "node", filter.extent());
    return is_selected;
}

std::vector<Face> selected_faces(const Selection& selection, const SelectableMesh& in) {
    const auto is_selected = selected_nodes(selection, in);
    auto faces = boundary_faces(in.mesh, [&](Index node) { return is_selected[node] != 0; });
    if (faces.empty()) refuse_empty(selection, "face (all of whose nodes are)", extent_of(in.mesh));
    return faces;
}

std::vector<std::uint8_t> selected_elements(const Selection& selection, const SolidMesh& mesh) {
    for (const char* key : {"side", "point_mm", "point_array"})
        if (selection.source.has(key))
            selection.source.refuse(key,
                                    "allowed for elements: from_mm, to_mm, centre_mm with "
                                    "radius_mm, which their centres are in");
    const PlaceFilter filter(selection, mesh);
    std::vector<std::uint8_t> is_selected(mesh.region.size(), 0);
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        Vec3 centre = Vec3::Zero();
        const int corners = mesh.table().num_corners;
        for (int a = 0; a < corners; ++a) centre += mesh.nodes[mesh.nodes_of(e)[a]] / corners;
        is_selected[e] = filter.takes(centre);
    }
    if (std::count(is_selected.begin(), is_selected.end(), 1) == 0)
        refuse_empty(selection, "element", filter.extent());
    return is_selected;
}

}  // namespace palpate

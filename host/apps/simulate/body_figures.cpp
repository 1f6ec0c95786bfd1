// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/body_figures.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/apps/simulate/mesh_picture.hpp"
#include "host/apps/simulate/simulation_findings.hpp"
#include "host/page/derived_shape.hpp"
#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"

namespace palpate {
namespace {

/// A little beside the middle of the mesh along y, where no regular grid has nodes.
double middle_y(const SolidMesh& mesh) {
    constexpr double beside = 3.7e-4;  ///< of the extent
    const auto [low, high] =
        std::minmax_element(mesh.nodes.begin(), mesh.nodes.end(),
                            [](const Vec3& a, const Vec3& b) { return a.y() < b.y(); });
    return low->y() + (0.5 + beside) * (high->y() - low->y());
}

MeshPicture picture_of(const std::string& quantity, std::vector<double> value) {
    const double high = *std::max_element(value.begin(), value.end());
    return {quantity, std::move(value), 0, high > 0 ? high : 1, {}};
}

std::vector<double> displacement_lengths(const SimulationState& state) {
    std::vector<double> lengths;
    for (Eigen::Index n = 0; 3 * n < state.displacement.size(); ++n)
        lengths.push_back(state.displacement.segment<3>(3 * n).norm());
    return lengths;
}

std::vector<Obstacle> obstacles_of(const SimulationResult& result, const SimulationState& state) {
    std::vector<Obstacle> obstacles;
    for (std::size_t k = 0; k < state.obstacle_motion_mm.size(); ++k) {
        obstacles.push_back(result.settings.obstacles[k].obstacle);
        obstacles.back().place += state.obstacle_motion_mm[k];
    }
    return obstacles;
}

/// The surface of a body, of large ones thinned; whether it is.
bool thin(PictureShape& body, const SolidMesh& mesh) {
    constexpr std::size_t most_patches = 20000;
    if (!body.is_closed || body.patches.size() <= most_patches) return false;
    std::vector<Triangle> corners;
    for (const auto& rim : body.patches)
        corners.push_back({rim[0], rim[rim.size() / 3], rim[2 * (rim.size() / 3)]});
    const DerivedShape few = thinned_to(most_patches, mesh.nodes, corners);
    body.patches.clear();
    for (const auto& [a, b, c] : few.triangles)
        body.patches.push_back({few.source[a], few.source[b], few.source[c]});
    return true;
}

std::string figure(const std::string& svg, const std::string& caption) {
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>", svg, escape_html(caption));
}

std::string view_note(Formulation formulation) {
    switch (formulation) {
        case Formulation::solid:
            return "The surface is seen obliquely from the front (along y) and above; z points up.";
        case Formulation::axisymmetric:
            return "The section through the axis, which runs upward in the middle; its left half "
                   "is the mirror image.";
        default:
            return "The section itself: x to the right, y upward.";
    }
}

}  // namespace

std::string body_figures(const SimulationResult& result) {
    const SimulationState& state = result.states[shown_state(result)];
    const SolidMesh& mesh = result.mesh();
    const double factor = enlargement(mesh, largest_displacement(state).length_mm);
    const std::string how = fmt::format(
        "{}, {}. Dashed: the outline at rest.", time_text(result, state.time_s),
        factor == 1 ? "in true proportion"
                    : fmt::format("displacements drawn {} times as large", significant(factor)));
    std::vector<MeshPicture> pictures{
        picture_of("displacement, mm", displacement_lengths(state)),
        picture_of("von Mises stress, kPa", at_nodes(mesh, state.cells.von_mises_kpa))};
    const char* names[] = {"Displacement", "Von Mises stress"};

    std::string surface, sections;
    PictureShape body = body_shape(mesh);
    const bool is_thinned = thin(body, mesh);
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        pictures[k].obstacles = obstacles_of(result, state);
        surface += figure(mesh_picture_svg(mesh, body, state.displacement, factor, pictures[k],
                                           fmt::format("body-{}", k)),
                          fmt::format("{} {}{}", names[k], how,
                                      pictures[k].obstacles.empty() ? "" : " Blue: obstacles."));
    }
    surface = fmt::format(
        "<div class='still'><div class='figures'>{}</div><p class='caption'>{}{}</p></div>",
        surface, view_note(mesh.formulation),
        is_thinned ? " To keep this page small its triangles are thinned." : "");
    if (!body.is_closed) return surface;
    const double y_mm = middle_y(mesh);
    const PictureShape section = section_shape(mesh, y_mm);
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        pictures[k].obstacles.clear();
        sections += figure(mesh_picture_svg(mesh, section, state.displacement, factor, pictures[k],
                                            fmt::format("section-{}", k)),
                           fmt::format("{} {} Section that was at y = {} mm, seen from the front: "
                                       "x to the right, z upward.",
                                       names[k], how, significant(y_mm)));
    }
    return surface + "<div class='figures'>" + sections + "</div>";
}

}  // namespace palpate

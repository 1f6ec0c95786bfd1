// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/simulation/mesh_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "host/report/findings.hpp"
#include "host/report/markup.hpp"
#include "host/report/plot.hpp"
#include "solver/model/surface_load.hpp"

namespace palpate {
namespace {

constexpr double width = 440, tallest_body = 330, margin = 14, scale_height = 62;
constexpr std::size_t most_with_lines = 6000;  ///< patches; beyond, mesh lines would be a blur

/// The sequential map of surface_viewer.js (after viridis).
constexpr std::array<std::array<int, 3>, 9> colour_map{{{0x44, 0x01, 0x54},
                                                        {0x47, 0x2d, 0x7b},
                                                        {0x3b, 0x52, 0x8b},
                                                        {0x2c, 0x72, 0x8e},
                                                        {0x21, 0x91, 0x8c},
                                                        {0x28, 0xae, 0x80},
                                                        {0x5e, 0xc9, 0x62},
                                                        {0xad, 0xdc, 0x30},
                                                        {0xfd, 0xe7, 0x25}}};

std::string colour_at(double part, double light) {
    const double place = std::clamp(part, 0.0, 1.0) * (colour_map.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(place), colour_map.size() - 2);
    std::array<int, 3> rgb;
    for (int c = 0; c < 3; ++c) {
        const double value = colour_map[k][c] + (place - static_cast<double>(k)) *
                                                    (colour_map[k + 1][c] - colour_map[k][c]);
        rgb[c] = std::clamp(static_cast<int>(std::lround(light * value)), 0, 255);
    }
    return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

/// Axes of the picture: to the right, up, and toward the eye.
struct View {
    Vec3 right = Vec3::UnitX(), up = Vec3::UnitY(), eye = Vec3::UnitZ();

    static View of(Formulation formulation) {
        if (formulation != Formulation::solid) return {};
        constexpr double turn = -0.55, tilt = 0.38;
        return {
            Vec3(std::cos(turn), std::sin(turn), 0),
            Vec3(-std::sin(tilt) * std::sin(turn), std::sin(tilt) * std::cos(turn), std::cos(tilt)),
            Vec3(std::cos(tilt) * std::sin(turn), -std::cos(tilt) * std::cos(turn),
                 std::sin(tilt))};
    }
};

/// A polygon of the picture by node numbers; corners and middles in the order of the rim.
struct Patch {
    std::vector<Index> nodes;
    int num_corners = 3;
};

std::vector<Index> rim_of(std::span<const Index> nodes, int num_corners) {
    std::vector<Index> rim;
    const bool has_middles = static_cast<int>(nodes.size()) == 2 * num_corners;
    for (int a = 0; a < num_corners; ++a) {
        rim.push_back(nodes[a]);
        if (has_middles) rim.push_back(nodes[num_corners + a]);
    }
    return rim;
}

std::vector<Patch> patches_of(const SolidMesh& mesh) {
    std::vector<Patch> patches;
    if (mesh.formulation == Formulation::solid) {
        for (const Face& face : boundary_faces(mesh)) patches.push_back({rim_of(face, 3), 3});
        return patches;
    }
    const int corners = mesh.table().num_corners;
    for (Index e = 0; e < mesh.num_elements(); ++e)
        patches.push_back({rim_of(mesh.nodes_of(e), corners), corners});
    return patches;
}

Vec3 normal_of(const Patch& patch, const std::vector<Vec3>& places) {
    Vec3 normal = Vec3::Zero();
    const Vec3& first = places[patch.nodes[0]];
    for (std::size_t a = 1; a + 1 < patch.nodes.size(); ++a)
        normal += (places[patch.nodes[a]] - first).cross(places[patch.nodes[a + 1]] - first);
    return normal.normalized();
}

using Edge = std::pair<Index, Index>;

/// Edges of the outline: of one patch only, on a sharp ridge, or between what is seen and what is
/// not.
std::vector<Edge> outline(const std::vector<Patch>& patches, const std::vector<Vec3>& places,
                          const Vec3& eye) {
    constexpr double sharp_cosine = 0.7;
    std::map<Edge, std::vector<Vec3>> normals;
    for (const Patch& patch : patches) {
        const Vec3 normal = normal_of(patch, places);
        for (std::size_t a = 0; a < patch.nodes.size(); ++a) {
            const auto edge =
                std::minmax(patch.nodes[a], patch.nodes[(a + 1) % patch.nodes.size()]);
            normals[edge].push_back(normal);
        }
    }
    std::vector<Edge> edges;
    for (const auto& [edge, sides] : normals) {
        const bool is_rim = sides.size() == 1;
        const bool is_ridge = !is_rim && sides[0].dot(sides[1]) < sharp_cosine;
        const bool is_silhouette = !is_rim && (sides[0].dot(eye) > 0) != (sides[1].dot(eye) > 0);
        if (is_rim || is_ridge || is_silhouette) edges.push_back(edge);
    }
    return edges;
}

/// Places of the picture in SVG units.
class Frame {
public:
    Frame(const View& view, bool is_mirrored, const std::vector<Vec3>& rest,
          const std::vector<Vec3>& moved)
        : view_(view) {
        Eigen::Vector2d low(INFINITY, INFINITY), high(-INFINITY, -INFINITY);
        for (const auto* places : {&rest, &moved})
            for (const Vec3& place : *places) {
                const Eigen::Vector2d at(place.dot(view.right), place.dot(view.up));
                low = low.cwiseMin(at);
                high = high.cwiseMax(at);
                if (is_mirrored) low.x() = std::min(low.x(), -at.x());
            }
        centre_ = (low + high) / 2;
        const Eigen::Vector2d size = (high - low).cwiseMax(1e-9);
        pixels_per_mm = std::min((width - 2 * margin) / size.x(), tallest_body / size.y());
        body_height = 2 * margin + pixels_per_mm * size.y();
    }
    std::string point(const Vec3& place) const {
        const double x = place.dot(view_.right) - centre_.x();
        const double y = place.dot(view_.up) - centre_.y();
        return fmt::format("{:.1f} {:.1f}", width / 2 + pixels_per_mm * x,
                           body_height / 2 - pixels_per_mm * y);
    }
    double pixels_per_mm = 1, body_height = 1;

private:
    const View& view_;
    Eigen::Vector2d centre_;
};

/// The patches that face the eye, the farthest first.
std::vector<const Patch*> in_drawing_order(const std::vector<Patch>& patches,
                                           const std::vector<Vec3>& places, const View& view,
                                           bool is_solid) {
    std::vector<std::pair<double, const Patch*>> seen;
    for (const Patch& patch : patches) {
        if (is_solid && normal_of(patch, places).dot(view.eye) <= 0) continue;
        double depth = 0;
        for (const Index node : patch.nodes) depth += places[node].dot(view.eye);
        seen.emplace_back(depth / static_cast<double>(patch.nodes.size()), &patch);
    }
    std::stable_sort(seen.begin(), seen.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<const Patch*> order;
    for (const auto& [depth, patch] : seen) order.push_back(patch);
    return order;
}

std::string patch_path(const Patch& patch, const std::vector<Vec3>& places, const Frame& frame,
                       const std::string& colour, bool has_lines) {
    std::string path;
    for (const Index node : patch.nodes)
        path += fmt::format("{}{}", path.empty() ? 'M' : 'L', frame.point(places[node]));
    return fmt::format("<path d='{}Z' fill='{}'{}/>", path, colour,
                       has_lines ? "" : fmt::format(" stroke='{}'", colour));
}

std::string colour_scale(const MeshPicture& picture, const std::string& id, double top) {
    const double left = width / 2 - 130, right = width / 2 + 130, y = top + 8;
    std::string stops;
    for (std::size_t k = 0; k < colour_map.size(); ++k) {
        const double part = static_cast<double>(k) / (colour_map.size() - 1);
        stops += fmt::format("<stop offset='{:.3f}' stop-color='{}'/>", part, colour_at(part, 1));
    }
    std::string out = fmt::format(
        "<linearGradient id='{0}'>{1}</linearGradient><rect x='{2}' y='{3}' width='{4}' "
        "height='10' "
        "fill='url(#{0})' class='strip'/>",
        id, stops, left, y, right - left);
    for (const double part : {0.0, 0.5, 1.0})
        out += fmt::format("<text class='tick' x='{:.1f}' y='{}' text-anchor='middle'>{}</text>",
                           left + part * (right - left), y + 23,
                           significant(picture.low + part * (picture.high - picture.low)));
    return out + fmt::format("<text class='label' x='{}' y='{}' text-anchor='middle'>{}</text>",
                             width / 2, y + 41, escape_html(picture.quantity));
}

std::string scale_bar(double pixels_per_mm, double top) {
    double length = std::pow(10, std::floor(std::log10(80 / pixels_per_mm)));
    for (const double step : {5.0, 2.0})
        if (step * length * pixels_per_mm <= 80) {
            length *= step;
            break;
        }
    const double y = top + 16;
    return fmt::format(
        "<path class='scale-bar' d='M{0} {1}v-4v4h{2:.1f}v-4'/><text class='tick' x='{0}' "
        "y='{3}'>{4:g} mm</text>",
        margin, y, length * pixels_per_mm, y + 15, length);
}

}  // namespace

std::vector<double> at_nodes(const SolidMesh& mesh, const std::vector<double>& of_elements) {
    std::vector<double> sum(mesh.nodes.size(), 0.0), count(mesh.nodes.size(), 0.0);
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (const Index node : mesh.nodes_of(e)) {
            sum[node] += of_elements[e];
            count[node] += 1;
        }
    for (std::size_t n = 0; n < sum.size(); ++n)
        if (count[n] > 0) sum[n] /= count[n];
    return sum;
}

double enlargement(const SolidMesh& mesh, double largest_mm) {
    constexpr double visible_part = 0.02;
    Vec3 low = mesh.nodes.front(), high = low;
    for (const Vec3& place : mesh.nodes) {
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
    }
    const double wanted = visible_part * (high - low).norm() / largest_mm;
    if (!(wanted > 1) || !std::isfinite(wanted)) return 1;
    const double power = std::pow(10, std::floor(std::log10(wanted)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= wanted) return step * power;
    return 10 * power;
}

std::string mesh_picture_svg(const SolidMesh& mesh, const Eigen::VectorXd& u, double factor,
                             const MeshPicture& picture, const std::string& id) {
    const bool is_solid = mesh.formulation == Formulation::solid;
    const bool is_mirrored = mesh.formulation == Formulation::axisymmetric;
    const View view = View::of(mesh.formulation);
    std::vector<Vec3> rest = mesh.nodes, moved = mesh.nodes;
    for (std::size_t n = 0; n < moved.size(); ++n)
        moved[n] += factor * u.segment<3>(3 * static_cast<Eigen::Index>(n));
    const std::vector<Patch> patches = patches_of(mesh);
    const Frame frame(view, is_mirrored, rest, moved);
    const auto order = in_drawing_order(patches, moved, view, is_solid);
    const bool has_lines = order.size() <= most_with_lines;
    const std::vector<Edge> edges = outline(patches, rest, view.eye);

    const Vec3 to_light = (view.eye + 0.6 * view.up - 0.5 * view.right).normalized();
    std::string faces, lines;
    const auto draw_half = [&] {
        for (const Patch* patch : order) {
            double value = 0;
            for (const Index node : patch->nodes) value += picture.value[node];
            value /= static_cast<double>(patch->nodes.size());
            const double light =
                is_solid ? 0.72 + 0.33 * std::max(0.0, normal_of(*patch, moved).dot(to_light)) : 1;
            const double part = (value - picture.low) / (picture.high - picture.low);
            faces += patch_path(*patch, moved, frame, colour_at(part, light), has_lines);
        }
        for (const auto& [a, b] : edges) {
            if (is_mirrored && rest[a].x() == 0 && rest[b].x() == 0) continue;  // the axis
            lines += fmt::format("M{}L{}", frame.point(rest[a]), frame.point(rest[b]));
        }
    };
    draw_half();
    if (is_mirrored) {
        for (auto* places : {&rest, &moved})
            for (Vec3& place : *places) place.x() = -place.x();
        draw_half();
    }
    return fmt::format(
        "<svg class='plot body' viewBox='0 0 {} {}' role='img' aria-label='{}'><g class='{}'>{}</g>"
        "<path class='rest' d='{}'/>{}{}</svg>",
        width, frame.body_height + scale_height, escape_html("Deformed body: " + picture.quantity),
        has_lines ? "faces lined" : "faces", faces, lines,
        colour_scale(picture, id, frame.body_height),
        scale_bar(frame.pixels_per_mm, frame.body_height));
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/mesh_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"

namespace palpate {
namespace {

constexpr double width = PictureFrame::width, margin = PictureFrame::margin;
constexpr double scale_height = 62;
constexpr std::size_t most_with_lines = 6000;  ///< patches; beyond, mesh lines would be a blur

/// The sequential map of surface_renderer.js (after viridis).
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

using Patch = std::vector<Index>;

Vec3 normal_of(const Patch& patch, const std::vector<Vec3>& places) {
    Vec3 normal = Vec3::Zero();
    const Vec3& first = places[patch[0]];
    for (std::size_t a = 1; a + 1 < patch.size(); ++a)
        normal += (places[patch[a]] - first).cross(places[patch[a + 1]] - first);
    return normal.normalized();
}

using Edge = std::pair<Index, Index>;

/// Edges of the outline: of one patch only, and of a closed surface those on a sharp ridge or
/// between what is seen and what is not.
std::vector<Edge> outline(const std::vector<Patch>& patches, const std::vector<Vec3>& places,
                          const Vec3& eye, bool is_closed) {
    constexpr double sharp_cosine = 0.7;
    std::map<Edge, std::vector<Vec3>> normals;
    for (const Patch& patch : patches) {
        const Vec3 normal = normal_of(patch, places);
        for (std::size_t a = 0; a < patch.size(); ++a) {
            const auto edge = std::minmax(patch[a], patch[(a + 1) % patch.size()]);
            normals[edge].push_back(normal);
        }
    }
    std::vector<Edge> edges;
    for (const auto& [edge, sides] : normals) {
        const bool is_rim = sides.size() == 1;
        const bool is_ridge = is_closed && !is_rim && sides[0].dot(sides[1]) < sharp_cosine;
        const bool is_silhouette =
            is_closed && !is_rim && (sides[0].dot(eye) > 0) != (sides[1].dot(eye) > 0);
        if (is_rim || is_ridge || is_silhouette) edges.push_back(edge);
    }
    return edges;
}

/// The patches that face the eye, the farthest first.
std::vector<const Patch*> in_drawing_order(const std::vector<Patch>& patches,
                                           const std::vector<Vec3>& places, const Vec3& eye,
                                           bool is_closed) {
    std::vector<std::pair<double, const Patch*>> seen;
    for (const Patch& patch : patches) {
        if (is_closed && normal_of(patch, places).dot(eye) <= 0) continue;
        double depth = 0;
        for (const Index node : patch) depth += places[node].dot(eye);
        seen.emplace_back(depth / static_cast<double>(patch.size()), &patch);
    }
    std::stable_sort(seen.begin(), seen.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<const Patch*> order;
    for (const auto& [depth, patch] : seen) order.push_back(patch);
    return order;
}

std::string faces_svg(const std::vector<const Patch*>& order, const std::vector<Vec3>& places,
                      const std::vector<double>& value, const MeshPicture& picture,
                      const PictureFrame& frame, bool is_closed) {
    const PictureView& view = frame.view();
    const Vec3 to_light = (view.eye + 0.6 * view.up - 0.5 * view.right).normalized();
    const bool has_lines = order.size() <= most_with_lines;
    std::string out;
    for (const Patch* patch : order) {
        double mean = 0;
        std::string path;
        for (const Index node : *patch) {
            mean += value[node] / static_cast<double>(patch->size());
            path += fmt::format("{}{}", path.empty() ? 'M' : 'L', frame.point(places[node]));
        }
        const double light =
            is_closed ? 0.72 + 0.33 * std::max(0.0, normal_of(*patch, places).dot(to_light)) : 1;
        const std::string colour =
            colour_at((mean - picture.low) / (picture.high - picture.low), light);
        out += fmt::format("<path d='{}Z' fill='{}'{}/>", path, colour,
                           has_lines ? "" : fmt::format(" stroke='{}'", colour));
    }
    return out;
}

std::string lines_path(const std::vector<Edge>& edges, const std::vector<Vec3>& places,
                       const PictureFrame& frame) {
    std::string path;
    for (const auto& [a, b] : edges)
        path += fmt::format("M{}L{}", frame.point(places[a]), frame.point(places[b]));
    return path;
}

std::string walls_svg(const std::string& path, const PictureFrame& frame, const std::string& id) {
    if (path.empty()) return "";
    return fmt::format(
        "<clipPath id='{0}-clip'><rect width='{1}' height='{2}'/></clipPath><path class='wall' "
        "clip-path='url(#{0}-clip)' d='{3}'/>",
        id, width, frame.height(), path);
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

std::string mesh_picture_svg(const SolidMesh& mesh, const PictureShape& shape,
                             const Eigen::VectorXd& u, double factor, const MeshPicture& picture,
                             const std::string& id) {
    std::vector<Vec3> nodes = mesh.nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        nodes[n] += factor * u.segment<3>(3 * static_cast<Eigen::Index>(n));
    std::vector<Vec3> rest, moved;
    std::vector<double> value;
    for (const PicturePoint& point : shape.points) {
        rest.push_back(point.of(mesh.nodes));
        moved.push_back(point.of(nodes));
        value.push_back(point.of(picture.value));
    }
    const PictureFrame frame(shape.view, shape.is_mirrored, rest, moved, picture.obstacles);
    const auto order = in_drawing_order(shape.patches, moved, shape.view.eye, shape.is_closed);
    std::vector<Edge> edges = outline(shape.patches, rest, shape.view.eye, shape.is_closed);
    if (shape.is_mirrored)  // the axis is no outline
        std::erase_if(edges, [&](const Edge& edge) {
            return rest[edge.first].x() == 0 && rest[edge.second].x() == 0;
        });

    std::string faces = faces_svg(order, moved, value, picture, frame, shape.is_closed);
    std::string lines = lines_path(edges, rest, frame);
    std::string walls = frame.outlines(picture.obstacles, 1);
    if (shape.is_mirrored) {
        for (auto* places : {&rest, &moved})
            for (Vec3& place : *places) place.x() = -place.x();
        faces += faces_svg(order, moved, value, picture, frame, shape.is_closed);
        lines += lines_path(edges, rest, frame);
        walls += frame.outlines(picture.obstacles, -1);
    }
    return fmt::format(
        "<svg class='plot body' viewBox='0 0 {} {}' role='img' aria-label='{}'><g class='{}'>{}</g>"
        "<path class='rest' d='{}'/>{}{}{}</svg>",
        width, frame.height() + scale_height, escape_html("Deformed body: " + picture.quantity),
        order.size() <= most_with_lines ? "faces lined" : "faces", faces, lines,
        walls_svg(walls, frame, id), colour_scale(picture, id, frame.height()),
        scale_bar(frame.pixels_per_mm(), frame.height()));
}

}  // namespace palpate

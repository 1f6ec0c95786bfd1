// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/obstacle_shape.hpp"

#include <cmath>
#include <numbers>

#include "host/apps/simulate/obstacle_outline.hpp"

namespace palpate {
namespace {

/// A net of rows x columns quadrilaterals, closed round the columns; the first and the last row may
/// be one point each.
template <class Place>
TriangleShape net(Index rows, Index columns, bool has_poles, const Place& place) {
    TriangleShape shape;
    for (Index r = 0; r <= rows; ++r)
        for (Index c = 0; c < columns; ++c)
            shape.vertices.push_back(place(double(r) / rows, double(c) / columns));
    const auto at = [&](Index r, Index c) {
        const bool is_pole = has_poles && (r == 0 || r == rows);
        return r * columns + (is_pole ? 0 : c % columns);
    };
    const auto add = [&](Index a, Index b, Index c) {
        if (a != b && b != c && c != a) shape.triangles.push_back({a, b, c});
    };
    for (Index r = 0; r < rows; ++r)
        for (Index c = 0; c < columns; ++c) {
            add(at(r, c), at(r, c + 1), at(r + 1, c));
            add(at(r, c + 1), at(r + 1, c + 1), at(r + 1, c));
        }
    return shape;
}

/// A tube or punch in a plane: both halves of its section, each a convex polygon.
TriangleShape section_of(const Obstacle& obstacle, double far_mm) {
    const Vec3 along = obstacle.direction.normalized(), right(along.y(), -along.x(), 0);
    std::vector<Eigen::Vector2d> line = outline_of(obstacle, far_mm);
    if (obstacle.shape == ObstacleShape::punch) line.emplace_back(0, -far_mm);
    const Index count = static_cast<Index>(line.size());
    TriangleShape shape;
    for (const double side : {1.0, -1.0}) {
        const Index first = static_cast<Index>(shape.vertices.size());
        for (const Eigen::Vector2d& at : line)
            shape.vertices.push_back(obstacle.place + side * at.x() * right + at.y() * along);
        for (Index k = 1; k + 1 < count; ++k)
            shape.triangles.push_back({first, first + k, first + k + 1});
    }
    return shape;
}

/// A tube or punch in space: its outline turned round its axis.
TriangleShape turned_outline(const Obstacle& obstacle, double far_mm, const Vec3& along,
                             const Vec3& right, const Vec3& up) {
    const std::vector<Eigen::Vector2d> line = outline_of(obstacle, far_mm);
    const Index rows = static_cast<Index>(line.size()) - 1;
    return net(rows, 48, false, [&](double row, double column) {
        const Eigen::Vector2d& at = line[static_cast<std::size_t>(std::lround(row * rows))];
        const double around = 2 * std::numbers::pi * column;
        return Vec3(obstacle.place + at.y() * along +
                    at.x() * (std::cos(around) * right + std::sin(around) * up));
    });
}

}  // namespace

TriangleShape obstacle_shape(const Obstacle& obstacle, const Eigen::AlignedBox3d& body,
                             bool is_plane) {
    constexpr double beyond = 0.55;  ///< of the body's diagonal, on each side of its middle
    constexpr double turn = 2 * std::numbers::pi;
    const double reach = beyond * body.diagonal().norm();
    const Vec3 along = obstacle.direction.normalized(), right = along.unitOrthogonal(),
               up = along.cross(right);
    const Vec3 offset = body.center() - obstacle.place;
    if (has_edge(obstacle.shape))
        return is_plane ? section_of(obstacle, reach)
                        : turned_outline(obstacle, reach, along, right, up);
    if (obstacle.shape == ObstacleShape::plane) {
        const Vec3 middle = body.center() - offset.dot(along) * along;
        TriangleShape shape{{}, {{0, 1, 2}, {0, 2, 3}}};
        for (const double part : {0.125, 0.375, 0.625, 0.875})
            shape.vertices.push_back(
                middle + reach * (std::cos(turn * part) * right + std::sin(turn * part) * up));
        return shape;
    }
    if (obstacle.shape == ObstacleShape::sphere || is_plane)
        return net(16, 48, true, [&](double row, double column) {
            const double polar = std::numbers::pi * row, around = turn * column;
            return Vec3(obstacle.place +
                        obstacle.radius_mm * Vec3(std::sin(polar) * std::cos(around),
                                                  std::sin(polar) * std::sin(around),
                                                  std::cos(polar)));
        });
    const Vec3 middle = obstacle.place + offset.dot(along) * along;
    return net(1, 48, false, [&](double row, double column) {
        return Vec3(middle + reach * (2 * row - 1) * along +
                    obstacle.radius_mm *
                        (std::cos(turn * column) * right + std::sin(turn * column) * up));
    });
}

}  // namespace palpate

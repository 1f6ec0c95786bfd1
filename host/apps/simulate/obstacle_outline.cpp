// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/obstacle_outline.hpp"

#include <cmath>
#include <numbers>

namespace palpate {

std::vector<Eigen::Vector2d> outline_of(const Obstacle& obstacle, double far_mm) {
    constexpr int pieces = 8;
    std::vector<Eigen::Vector2d> line;
    const auto add_arc = [&](double centre, double radius, double from, double to) {
        for (int k = 0; k <= pieces; ++k) {
            const double angle = from + (to - from) * k / pieces;
            line.emplace_back(centre + radius * std::cos(angle), radius * (std::sin(angle) - 1));
        }
    };
    constexpr double right = 0, up = std::numbers::pi / 2, left = std::numbers::pi;
    if (obstacle.shape == ObstacleShape::punch) {
        const double edge = obstacle.edge_radius_mm, side = obstacle.radius_mm;
        line.emplace_back(0, 0);
        add_arc(side - edge, edge, up, right);
        line.emplace_back(side, -far_mm);
        return line;
    }
    const double edge = obstacle.edge_radius_mm, outer_edge = obstacle.outer_edge_radius_mm;
    line.emplace_back(obstacle.radius_mm, -far_mm);
    add_arc(obstacle.radius_mm + edge, edge, left, up);
    add_arc(obstacle.outer_radius_mm - outer_edge, outer_edge, up, right);
    line.emplace_back(obstacle.outer_radius_mm, -far_mm);
    return line;
}

}  // namespace palpate

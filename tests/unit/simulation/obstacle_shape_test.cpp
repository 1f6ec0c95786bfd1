// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/obstacle_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solver/model/obstacle_depth.hpp"

namespace palpate {
namespace {

Obstacle obstacle_of(ObstacleShape shape, const Vec3& direction) {
    return {.shape = shape,
            .place = Vec3(0, 1, 0),
            .direction = direction,
            .radius_mm = 5,
            .edge_radius_mm = 0.5,
            .outer_radius_mm = 9,
            .outer_edge_radius_mm = 1};
}

/// Whatever touches is drawn where it touches: a vertex that is not at the end where what has no
/// end is cut off lies on the surface that contact knows.
void expect_drawn_where_it_touches(const Obstacle& obstacle, bool is_plane) {
    const Eigen::AlignedBox3d body(Vec3(-10, -8, is_plane ? 0 : -10),
                                   Vec3(10, 0, is_plane ? 0 : 10));
    const TriangleShape drawn = obstacle_shape(obstacle, body, is_plane);
    std::size_t num_on_surface = 0;
    for (const Vec3& vertex : drawn.vertices) {
        const Triple<double> y{vertex.x(), vertex.y(), vertex.z()};
        if (std::abs(depth_in(obstacle, y).depth) < 1e-9) ++num_on_surface;
    }
    EXPECT_GE(num_on_surface, drawn.vertices.size() / 2);
    for (const Triangle& triangle : drawn.triangles)
        for (const Index corner : triangle) EXPECT_LT(corner, Index(drawn.vertices.size()));
    EXPECT_FALSE(drawn.triangles.empty());
}

TEST(ObstacleShapes, AreDrawnWhereContactHasThem) {
    for (const ObstacleShape shape :
         {ObstacleShape::plane, ObstacleShape::cylinder, ObstacleShape::sphere, ObstacleShape::tube,
          ObstacleShape::punch})
        expect_drawn_where_it_touches(obstacle_of(shape, -Vec3::UnitY()), false);
    for (const ObstacleShape shape :
         {ObstacleShape::plane, ObstacleShape::tube, ObstacleShape::punch})
        expect_drawn_where_it_touches(obstacle_of(shape, -Vec3::UnitY()), true);
}

}  // namespace
}  // namespace palpate

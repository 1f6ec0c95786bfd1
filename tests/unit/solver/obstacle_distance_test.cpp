// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/distance_by_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "solver/model/obstacle_depth.hpp"

namespace palpate {
namespace {

const Vec3 axis = Vec3(1, 2, 2) / 3, side = Vec3(2, 1, -2) / 3;

Obstacle tube() {
    Obstacle obstacle;
    obstacle.shape = ObstacleShape::tube;
    obstacle.place = Vec3(1, -2, 0.5);
    obstacle.direction = 3 * axis;
    obstacle.radius_mm = 2;
    obstacle.edge_radius_mm = 0.3;
    obstacle.outer_radius_mm = 4;
    obstacle.outer_edge_radius_mm = 0.5;
    return obstacle;
}

Obstacle punch() {
    Obstacle obstacle = tube();
    obstacle.shape = ObstacleShape::punch;
    return obstacle;
}

/// At a distance from the axis and a height over the end.
Vec3 at(const Obstacle& obstacle, double r, double h) {
    return obstacle.place + r * side + h * axis;
}

double distance(const Obstacle& obstacle, const Vec3& y) {
    return -depth_in<double>(obstacle, {y[0], y[1], y[2]}).depth;
}

using Plane = Eigen::Vector2d;

void add_line(Plane from, Plane to, std::vector<Plane>& points) {
    constexpr int count = 20000;
    for (int k = 0; k <= count; ++k) points.push_back(from + (to - from) * k / count);
}

void add_edge(Plane centre, double radius, double from, double to, std::vector<Plane>& points) {
    constexpr int count = 4000;
    for (int k = 0; k <= count; ++k) {
        const double angle = from + (to - from) * k / count;
        points.push_back(centre + radius * Plane(std::cos(angle), std::sin(angle)));
    }
}

/// The profile in (r, h), drawn as its words say.
std::vector<Plane> profile_of(const Obstacle& o) {
    constexpr double far = -12, quarter = std::numbers::pi / 2;
    std::vector<Plane> points;
    if (o.shape == ObstacleShape::punch) {
        const double flat = o.radius_mm - o.edge_radius_mm;
        add_line({0, 0}, {flat, 0}, points);
        add_edge({flat, -o.edge_radius_mm}, o.edge_radius_mm, quarter, 0, points);
        add_line({o.radius_mm, -o.edge_radius_mm}, {o.radius_mm, far}, points);
        return points;
    }
    const double from = o.radius_mm + o.edge_radius_mm;
    const double to = o.outer_radius_mm - o.outer_edge_radius_mm;
    add_line({o.radius_mm, far}, {o.radius_mm, -o.edge_radius_mm}, points);
    add_edge({from, -o.edge_radius_mm}, o.edge_radius_mm, 2 * quarter, quarter, points);
    add_line({from, 0}, {to, 0}, points);
    add_edge({to, -o.outer_edge_radius_mm}, o.outer_edge_radius_mm, quarter, 0, points);
    add_line({o.outer_radius_mm, -o.outer_edge_radius_mm}, {o.outer_radius_mm, far}, points);
    return points;
}

bool is_inside(const Obstacle& o, double r, double h) {
    if (h > 0) return false;
    const bool is_tube = o.shape == ObstacleShape::tube;
    if (r > (is_tube ? o.outer_radius_mm : o.radius_mm) || (is_tube && r < o.radius_mm))
        return false;
    const auto is_cut = [&](double centre, double radius, double outward) {
        const double over = outward * (r - centre);
        return over > 0 && h > -radius && std::hypot(over, h + radius) > radius;
    };
    if (!is_tube) return !is_cut(o.radius_mm - o.edge_radius_mm, o.edge_radius_mm, 1);
    return !is_cut(o.radius_mm + o.edge_radius_mm, o.edge_radius_mm, -1) &&
           !is_cut(o.outer_radius_mm - o.outer_edge_radius_mm, o.outer_edge_radius_mm, 1);
}

TEST(ObstacleDistance, IsThatToTheNearestPointOfTheProfile) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> radius(0.01, 6), height(-4, 2);
    for (const Obstacle& obstacle : {tube(), punch()}) {
        const std::vector<Plane> profile = profile_of(obstacle);
        for (int k = 0; k < 300; ++k) {
            const Plane place(radius(random), height(random));
            double nearest = 1e9;
            for (const Plane& point : profile)
                nearest = std::min(nearest, (point - place).squaredNorm());
            nearest = std::sqrt(nearest);
            const double expected = is_inside(obstacle, place.x(), place.y()) ? -nearest : nearest;
            EXPECT_NEAR(distance(obstacle, at(obstacle, place.x(), place.y())), expected, 2e-4)
                << name_of(obstacle.shape) << " at " << place.transpose();
        }
    }
}

/// Places on a line that crosses every seam, above and a little inside.
template <class Work>
void along_the_surface(const Obstacle& obstacle, double off_mm, const Work& work) {
    for (const Plane& point : profile_of(obstacle)) {
        if (point.x() < 1e-9 || point.y() < -3) continue;
        const Vec3 on = at(obstacle, point.x(), point.y());
        work(Vec3(on + off_mm * distance_by_shape(obstacle, on).normal));
    }
}

TEST(ObstacleDistance, GradientHasLengthOneAndNoJumpAcrossSeams) {
    for (const Obstacle& obstacle : {tube(), punch()})
        for (const double off_mm : {0.4, 0.0, -0.1, -0.2}) {
            Vec3 last_normal = Vec3::Zero();
            double largest_jump = 0;
            bool is_first = true;
            along_the_surface(obstacle, off_mm, [&](const Vec3& y) {
                const DistanceByShape found = distance_by_shape(obstacle, y);
                EXPECT_NEAR(found.distance_mm, off_mm, 1e-12);
                EXPECT_NEAR(found.normal.norm(), 1, 1e-14);
                if (!is_first)
                    largest_jump = std::max(largest_jump, (found.normal - last_normal).norm());
                is_first = false;
                last_normal = found.normal;
            });
            // A quarter turn in 4000 parts.
            EXPECT_LT(largest_jump, 5e-4) << name_of(obstacle.shape) << " at " << off_mm;
        }
}

TEST(ObstacleDistance, FlatsAreThoseOfAPlaneToTheLastBit) {
    Obstacle plane = tube();
    plane.shape = ObstacleShape::plane;
    for (const Obstacle& obstacle : {tube(), punch()}) {
        const double r = obstacle.shape == ObstacleShape::tube ? 3 : 1;
        for (const double h : {-0.2, 0.0, 0.7}) {
            const Vec3 y = at(obstacle, r, h);
            EXPECT_EQ(distance(obstacle, y), distance(plane, y));
        }
    }
    // In the middle of a punch and of a hole nothing is undefined.
    const DistanceByShape middle = distance_by_shape(punch(), punch().place - 0.1 * axis);
    EXPECT_TRUE(middle.normal.isApprox(axis) && middle.curvature.isZero(0));
    EXPECT_TRUE(distance_by_shape(tube(), tube().place - axis).normal.allFinite());
}

/// Off the seams, outside and inside.
std::vector<Vec3> places(const Obstacle& obstacle) {
    std::vector<Vec3> list;
    const bool is_tube = obstacle.shape == ObstacleShape::tube;
    for (const Plane& place :
         is_tube ? std::vector<Plane>{{2.1, 0.2},
                                      {2.2, -0.1},
                                      {1.9, -2},
                                      {2.1, -2},
                                      {3, 0.1},
                                      {3, -0.1},
                                      {3.9, 0.1},
                                      {3.8, -0.2},
                                      {4.2, -2}}
                 : std::vector<Plane>{
                       {1, 0.2}, {1, -0.2}, {1.9, 0.1}, {1.8, -0.2}, {2.2, -1}, {1.9, -1}})
        list.push_back(obstacle.place + place.x() * (0.6 * side + 0.8 * axis.cross(side)) +
                       place.y() * axis);
    return list;
}

TEST(ObstacleDistance, DerivativesAreThoseOfCentralDifferences) {
    constexpr double step = 1e-6;
    for (const Obstacle& obstacle : {tube(), punch()})
        for (const Vec3& y : places(obstacle)) {
            const DistanceByShape found = distance_by_shape(obstacle, y);
            for (int i = 0; i < 3; ++i) {
                const auto up = distance_by_shape(obstacle, y + step * Vec3::Unit(i));
                const auto down = distance_by_shape(obstacle, y - step * Vec3::Unit(i));
                EXPECT_NEAR((up.distance_mm - down.distance_mm) / (2 * step), found.normal[i],
                            1e-9);
                EXPECT_LT(((up.normal - down.normal) / (2 * step) - found.curvature.col(i)).norm(),
                          1e-8);
            }
            double Obstacle::*const sizes[] = {&Obstacle::radius_mm, &Obstacle::edge_radius_mm,
                                               &Obstacle::outer_radius_mm,
                                               &Obstacle::outer_edge_radius_mm};
            for (int k = 0; k < 4; ++k) {
                Obstacle larger = obstacle, smaller = obstacle;
                larger.*sizes[k] += step;
                smaller.*sizes[k] -= step;
                const auto up = distance_by_shape(larger, y), down = distance_by_shape(smaller, y);
                EXPECT_NEAR((up.distance_mm - down.distance_mm) / (2 * step), found.by_size[k],
                            1e-9)
                    << name_of(obstacle.shape) << " " << obstacle_sizes[k];
                EXPECT_LT(
                    ((up.normal - down.normal) / (2 * step) - found.normal_by_size.col(k)).norm(),
                    1e-8)
                    << name_of(obstacle.shape) << " " << obstacle_sizes[k];
            }
        }
}

// The curvature of a torus: 1 / e across the edge, and round the axis.
TEST(ObstacleDistance, AnEdgeIsAsCurvedAsATorus) {
    const Obstacle obstacle = punch();
    const double angle = 0.7, e = obstacle.edge_radius_mm;
    const double r = obstacle.radius_mm - e + e * std::cos(angle);
    const DistanceByShape found =
        distance_by_shape(obstacle, at(obstacle, r, e * (std::sin(angle) - 1)));
    const Vec3 tangent = -std::sin(angle) * side + std::cos(angle) * axis;
    const Vec3 round = axis.cross(side);
    EXPECT_NEAR(tangent.dot(found.curvature * tangent), 1 / e, 1e-9);
    EXPECT_NEAR(round.dot(found.curvature * round), std::cos(angle) / r, 1e-9);
    EXPECT_LT((found.curvature * found.normal).norm(), 1e-12);
}

TEST(ObstacleDistance, SizesOfOtherShapesAreKnownToo) {
    Obstacle sphere;
    sphere.shape = ObstacleShape::sphere;
    sphere.radius_mm = 2;
    const DistanceByShape found = distance_by_shape(sphere, Vec3(0, 3, 4));
    EXPECT_NEAR(found.distance_mm, 3, 1e-14);
    EXPECT_TRUE(found.by_size.isApprox(Eigen::RowVector4d(-1, 0, 0, 0)));
    EXPECT_NEAR(found.curvature.trace(), 2.0 / 5, 1e-14);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/closest_point.hpp"

#include <gtest/gtest.h>

#include <random>

#include "solver/base/error.hpp"
#include "tests/unit/surfaces/analytic_surfaces.hpp"

namespace palpate {
namespace {

using testing::sphere_surface;

Vec3 random_point(std::mt19937& random, double extent) {
    std::uniform_real_distribution<double> coordinate(-extent, extent);
    return Vec3(coordinate(random), coordinate(random), coordinate(random));
}

Surface random_triangles(std::mt19937& random, Index count) {
    Surface s;
    for (Index t = 0; t < count; ++t) {
        const Vec3 centre = random_point(random, 10);
        for (int v = 0; v < 3; ++v) s.vertices.push_back(centre + random_point(random, 2));
        s.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return s;
}

TEST(ClosestPoint, MatchesATestOfEveryTriangle) {
    std::mt19937 random(11);
    for (Index count : {1, 4, 5, 333}) {
        const Surface s = random_triangles(random, count);
        const ClosestPointQuery query(s);
        for (int n = 0; n < 300; ++n) {
            const Vec3 p = random_point(random, 15);
            double nearest = 1e300;
            for (const Triangle& t : s.triangles) {
                const Vec3 c = closest_point_of_triangle(p, s.vertices[t[0]], s.vertices[t[1]],
                                                         s.vertices[t[2]]);
                nearest = std::min(nearest, (p - c).norm());
            }
            const ClosestPoint found = query.closest(p);
            ASSERT_NEAR(found.distance_mm, nearest, 1e-12);
            ASSERT_NEAR((found.point - p).norm(), nearest, 1e-12);
        }
    }
}

TEST(ClosestPoint, OfATriangleIsNeverFartherThanASampleOfIt) {
    std::mt19937 random(5);
    for (int n = 0; n < 500; ++n) {
        const Vec3 a = random_point(random, 1), b = random_point(random, 1),
                   c = random_point(random, 1), p = random_point(random, 3);
        const double found = (closest_point_of_triangle(p, a, b, c) - p).norm();
        double sampled = 1e300;
        for (int i = 0; i <= 40; ++i)
            for (int j = 0; i + j <= 40; ++j)
                sampled =
                    std::min(sampled, (a + (b - a) * i / 40.0 + (c - a) * j / 40.0 - p).norm());
        ASSERT_LE(found, sampled + 1e-12);
        ASSERT_GE(found, sampled - 0.15);
    }
}

TEST(ClosestPoint, OfATriangleWithoutAreaIsOnItsLongestEdge) {
    const Vec3 a(0, 0, 0), b(2, 0, 0), above(1, 3, 0);

    EXPECT_EQ(closest_point_of_triangle(above, a, a, b), Vec3(1, 0, 0));
    EXPECT_EQ(closest_point_of_triangle(above, a, b, a), Vec3(1, 0, 0));
    EXPECT_EQ(closest_point_of_triangle(above, a, b, b), Vec3(1, 0, 0));
    EXPECT_EQ(closest_point_of_triangle(above, a, b, Vec3(0.5, 0, 0)), Vec3(1, 0, 0));
    EXPECT_EQ(closest_point_of_triangle(above, b, b, b), b);
}

TEST(ClosestPoint, ManyPointsAtOnceGiveTheSame) {
    std::mt19937 random(2);
    const ClosestPointQuery query(random_triangles(random, 200));
    std::vector<Vec3> points;
    for (int n = 0; n < 100; ++n) points.push_back(random_point(random, 15));

    const std::vector<ClosestPoint> together = query.closest(points);

    for (std::size_t n = 0; n < points.size(); ++n) {
        EXPECT_EQ(together[n].distance_mm, query.closest(points[n]).distance_mm);
        EXPECT_EQ(together[n].triangle, query.closest(points[n]).triangle);
    }
}

TEST(ClosestPoint, RefusesASurfaceWithoutTriangles) {
    EXPECT_THROW(ClosestPointQuery(Surface{}), Error);
}

TEST(ClosestPoint, RefusesAPointThatIsNotFinite) {
    const ClosestPointQuery query(sphere_surface(Vec3::Zero(), 1, 8));

    EXPECT_THROW(query.closest(Vec3(0, std::nan(""), 0)), Error);
}

TEST(SurfaceDistance, OfConcentricSpheresIsTheDifferenceOfTheirRadii) {
    const Surface inner = sphere_surface(Vec3(3, 4, 5), 10, 60),
                  outer = sphere_surface(Vec3(3, 4, 5), 12, 60);

    const SurfaceDistance d = surface_distance(inner, outer);

    EXPECT_NEAR(d.mean_mm, 2, 0.02);
    EXPECT_NEAR(d.rms_mm, 2, 0.02);
    EXPECT_NEAR(d.p95_mm, 2, 0.02);
    EXPECT_NEAR(d.max_mm, 2, 0.02);
}

TEST(SurfaceDistance, OfAShiftedSphereWeighsByArea) {
    // The distance along the shift t is |t cos|, whose mean over the sphere is t / 2.
    const Surface sphere = sphere_surface(Vec3::Zero(), 20, 80),
                  shifted = sphere_surface(Vec3(0, 0, 0.5), 20, 80);

    const SurfaceDistance d = surface_distance(sphere, shifted);

    EXPECT_NEAR(d.mean_mm, 0.25, 0.01);
    EXPECT_NEAR(d.rms_mm, 0.5 / std::sqrt(3), 0.01);
    EXPECT_NEAR(d.p95_mm, 0.475, 0.01);
    EXPECT_NEAR(d.max_mm, 0.5, 0.01);
}

}  // namespace
}  // namespace palpate

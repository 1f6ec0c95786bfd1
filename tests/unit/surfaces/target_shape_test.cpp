// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/target_shape.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "host/geometry/surfaces/orientation.hpp"
#include "host/geometry/surfaces/point_shape.hpp"
#include "host/geometry/surfaces/surface_shape.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double radius = 20.0;

/// The cap of a sphere within `degrees` of the z axis, triangles outward.
Surface cap(double degrees, Index rings, Index sectors) {
    Surface surface;
    surface.vertices.emplace_back(0, 0, radius);
    for (Index r = 1; r <= rings; ++r) {
        const double polar = degrees * std::numbers::pi / 180 * r / rings;
        for (Index s = 0; s < sectors; ++s) {
            const double angle = 2 * std::numbers::pi * s / sectors;
            surface.vertices.push_back(radius * Vec3(std::sin(polar) * std::cos(angle),
                                                     std::sin(polar) * std::sin(angle),
                                                     std::cos(polar)));
        }
    }
    const auto at = [&](Index r, Index s) {
        return r == 0 ? 0 : 1 + (r - 1) * sectors + s % sectors;
    };
    for (Index r = 0; r < rings; ++r) {
        for (Index s = 0; s < sectors; ++s) {
            surface.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
            if (r > 0) surface.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
        }
    }
    return surface;
}

Vec3 on_sphere(double polar_degrees, double distance) {
    const double polar = polar_degrees * std::numbers::pi / 180;
    return (radius + distance) *
           Vec3(std::sin(polar) * 0.6, std::sin(polar) * 0.8, std::cos(polar));
}

Vec3 from_centre(const Vec3& x) { return x; }

TEST(SurfaceShape, MeasuresAlongTheNormalAndEndsAtItsRim) {
    const SurfaceShape shape(cap(60, 30, 90));

    for (const double distance : {-3.0, 0.0, 2.0}) {
        const auto seen = shape.measure(on_sphere(30, distance), Vec3::Zero());
        EXPECT_TRUE(seen.is_seen);
        EXPECT_NEAR(seen.mm, distance, 0.03);
        EXPECT_GT(seen.normal.dot(on_sphere(30, 0).normalized()), 0.999);
    }
    EXPECT_FALSE(shape.measure(on_sphere(75, 1.0), Vec3::Zero()).is_seen);
}

TEST(SurfaceShape, SmoothNormalsLeaveOutWhatIsShort) {
    Surface bumpy = cap(60, 60, 180);  // waves of 4 mm along the surface, 0.3 mm high
    for (Vec3& x : bumpy.vertices) {
        const double polar = std::acos(std::clamp(x.z() / x.norm(), -1.0, 1.0));
        x *= 1 + 0.3 / radius * std::sin(2 * std::numbers::pi * radius * polar / 4);
    }
    const SurfaceShape shape(bumpy);
    double rough = 0, smooth = 0;
    for (double polar = 25; polar < 40; polar += 0.7) {
        const auto seen = shape.measure(on_sphere(polar, 0), Vec3::Zero());
        const Vec3 radial = on_sphere(polar, 0).normalized();
        rough = std::max(rough, (seen.normal - radial).norm());
        smooth = std::max(smooth, (seen.smooth_normal - radial).norm());
        EXPECT_NEAR(seen.smooth_normal.norm(), 1, 1e-9);
    }
    EXPECT_GT(rough, 0.3);
    EXPECT_LT(smooth, 0.03);
}

TEST(SurfaceShape, VanishesAtItsOwnVertices) {
    const Surface surface = cap(60, 10, 30);
    const SurfaceShape shape(surface);
    for (Index v = 0; v < 100; ++v) {
        EXPECT_NEAR(shape.measure(surface.vertices[v], Vec3::Zero()).mm, 0, 1e-12);
    }
}

TEST(SurfaceShape, SaysNothingAboutThePointsOfAnotherSide) {
    const SurfaceShape shape(cap(60, 30, 90));
    const Vec3 inside = on_sphere(20, -5);

    EXPECT_TRUE(shape.measure(inside, inside).is_seen);
    EXPECT_FALSE(shape.measure(inside, -inside).is_seen);
    EXPECT_FALSE(shape.measure(inside, Vec3(1, 0, 0)).is_seen);
}

TEST(PointShape, SeesAPlaneInItsClosestPointsAndEndsBesideThem) {
    const PointShape shape(cap(60, 30, 90).vertices, from_centre);

    for (const double distance : {-3.0, 1.5}) {
        const Vec3 point = on_sphere(35, distance);
        const auto seen = shape.measure(point, point);
        EXPECT_TRUE(seen.is_seen);
        EXPECT_NEAR(seen.mm, distance, 0.1);
        EXPECT_GT(seen.normal.dot(point.normalized()), 0.999);
        EXPECT_FALSE(shape.measure(point, -point).is_seen);
    }
    EXPECT_FALSE(shape.measure(on_sphere(80, 1.0), Vec3::Zero()).is_seen);
}

TEST(PointShape, IsTurnedAsAWholeByWhereMostOfItPointsOutward) {
    // Right only in the upper part of the cap.
    const auto half_right = [](const Vec3& x) { return x[2] > 14 ? x : Vec3(-x); };
    const PointShape shape(cap(60, 30, 90).vertices, half_right);

    EXPECT_NEAR(shape.measure(on_sphere(55, 1), Vec3::Zero()).mm, 1, 0.1);
}

TEST(PointShape, AveragesANoisyDenseCloudAndLeavesStraysOut) {
    constexpr double noise_mm = 0.5;
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, noise_mm);
    std::vector<Vec3> cloud;
    for (const Vec3& x : cap(60, 60, 240).vertices) {
        cloud.push_back(x + noise(random) * x.normalized());
    }
    for (int k = 0; k < 5; ++k) cloud.push_back(Vec3(40.0 + 9 * k, 7.0 * k, 60));

    const PointShape shape(cloud, from_centre, noise_mm);

    EXPECT_GT(shape.spacing_mm(), 0.5 * noise_mm);
    for (const Vec3& point : shape.points()) EXPECT_LT(point.norm(), radius + 4 * noise_mm);
    double worst = 0;
    for (double polar = 5; polar < 50; polar += 5) {
        const auto seen = shape.measure(on_sphere(polar, 1), on_sphere(polar, 1));
        EXPECT_TRUE(seen.is_seen) << polar;
        worst = std::max(worst, std::abs(seen.mm - 1));
    }
    EXPECT_LT(worst, noise_mm);
}

TEST(Orientation, TurnsEveryTriangleOfAnOpenSurfaceOutward) {
    const Surface right = cap(60, 8, 20);
    Surface mixed = right;
    for (std::size_t t = 0; t < mixed.triangles.size(); t += 3) {
        std::swap(mixed.triangles[t][0], mixed.triangles[t][1]);
    }

    const Surface turned = oriented_outward(mixed, from_centre);

    for (const Triangle& t : turned.triangles) {
        const Vec3& a = turned.vertices[t[0]];
        const Vec3 normal = (turned.vertices[t[1]] - a).cross(turned.vertices[t[2]] - a);
        EXPECT_GT(normal.dot(a), 0);
    }
}

TEST(PointShape, SaysHowManyPointsItNeeds) {
    try {
        PointShape shape(std::vector<Vec3>(7, Vec3::Zero()), from_centre);
        FAIL() << "seven points were taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("at least 8"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate

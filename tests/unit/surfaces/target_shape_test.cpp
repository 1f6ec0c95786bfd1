// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/surfaces/target_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/surfaces/point_shape.hpp"
#include "host/surfaces/surface_shape.hpp"
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

TEST(SurfaceShape, VanishesAtItsOwnVertices) {
    const Surface surface = cap(60, 10, 30);
    const SurfaceShape shape(surface);
    for (Index v = 0; v < 100; ++v) {
        EXPECT_NEAR(shape.measure(surface.vertices[v], Vec3::Zero()).mm, 0, 1e-12);
    }
}

TEST(PointShape, SeesAPlaneInItsClosestPointsAndTakesItsSignFromTheSurface) {
    const PointShape shape(cap(60, 30, 90).vertices);

    const Vec3 outside = on_sphere(35, 1.5);
    const auto seen = shape.measure(outside, outside);
    EXPECT_TRUE(seen.is_seen);
    EXPECT_NEAR(seen.mm, 1.5, 0.1);
    EXPECT_NEAR(shape.measure(outside, -outside).mm, -1.5, 0.1);
    EXPECT_FALSE(shape.measure(on_sphere(80, 1.0), outside).is_seen);
}

TEST(PointShape, SaysHowManyPointsItNeeds) {
    try {
        PointShape shape(std::vector<Vec3>(7, Vec3::Zero()));
        FAIL() << "seven points were taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("at least 8"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate

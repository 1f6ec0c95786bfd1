// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/organ_shape.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace palpate {
namespace {

OrganShape ball(double radius, const Vec3& centre = Vec3::Zero()) {
    OrganShape shape;
    shape.centre = centre;
    shape.semi_axes = Vec3::Constant(radius);
    return shape;
}

OrganShape turned_ellipsoid() {
    OrganShape shape;
    shape.centre = Vec3(3, -2, 5);
    shape.axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 2).normalized()).toRotationMatrix();
    shape.semi_axes = Vec3(8, 12, 20);
    return shape;
}

TEST(OrganShape, ValueOfABallIsTheSignedDistance) {
    const OrganShape shape = ball(10, {1, 2, 3});

    for (const double r : {9.0, 10.0, 11.0, 13.0}) {
        const Vec3 x = shape.centre + r * Vec3(2, -1, 2) / 3;
        EXPECT_NEAR(shape.value(x), r - 10, 0.02 * std::abs(r - 10) + 1e-9);
        EXPECT_LT((shape.normal(x) - Vec3(2, -1, 2) / 3).norm(), 1e-4);
    }
}

TEST(OrganShape, EllipsoidEndsAtItsSemiAxes) {
    const OrganShape shape = turned_ellipsoid();

    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            const Vec3 tip = shape.centre + side * shape.semi_axes[axis] * shape.axes.col(axis);
            EXPECT_NEAR(shape.value(tip), 0, 1e-9);
            EXPECT_GT(shape.value(tip + 0.5 * side * shape.axes.col(axis)), 0.4);
            EXPECT_LT(shape.value(tip - 0.5 * side * shape.axes.col(axis)), -0.4);
            EXPECT_LT((shape.normal(tip) - side * shape.axes.col(axis)).norm(), 1e-3);
        }
    EXPECT_GE(shape.reach(), 20);
}

TEST(OrganShape, SurfacePointsLieOnTheSurfaceWithinReach) {
    OrganShape shape = turned_ellipsoid();
    shape.taper = 0.2;
    shape.bend_mm = 3;
    shape.roundness = 3;

    const std::vector<Vec3> points = surface_points(shape, 400);

    ASSERT_EQ(points.size(), 400u);
    for (const Vec3& point : points) {
        EXPECT_NEAR(shape.value(shape.centre + point), 0, 0.01);
        EXPECT_LE(point.norm(), shape.reach());
    }
}

TEST(OrganShape, NormalIsTheSlopeOfTheValue) {
    OrganShape shape = turned_ellipsoid();
    shape.bend_mm = 4;
    shape.taper = 0.3;
    constexpr double step = 1e-4;

    for (const Vec3& point : surface_points(shape, 30)) {
        const Vec3 x = shape.centre + point;
        Vec3 slope;
        for (int axis = 0; axis < 3; ++axis)
            slope[axis] = (shape.value(x + step * Vec3::Unit(axis)) -
                           shape.value(x - step * Vec3::Unit(axis))) /
                          (2 * step);
        EXPECT_LT((shape.normal(x) - slope.normalized()).norm(), 1e-3);
        EXPECT_NEAR(shape.normal(x).norm(), 1, 1e-12);
    }
}

TEST(OrganShape, GapBetweenBallsIsKnown) {
    const OrganShape a = ball(10), apart = ball(6, {19, 0, 0}), over = ball(6, {14, 0, 0});

    EXPECT_NEAR(gap_between(a, surface_points(a, 2500), apart, surface_points(apart, 2500)), 3,
                0.2);
    EXPECT_NEAR(gap_between(a, surface_points(a, 2500), over, surface_points(over, 2500)), -2, 0.2);
}

TEST(OrganShape, ADentKeepsItsGapToTheOrganThatMadeIt) {
    OrganShape shape = ball(10);
    shape.dented_by = std::make_shared<const OrganShape>(ball(6, {14, 0, 0}));
    shape.dent_gap_mm = 1.5;

    // On the line between the centres the other organ begins at 8 mm: the wall lies at 6.5 mm.
    EXPECT_NEAR(shape.value({6.5, 0, 0}), 0, 0.05);
    EXPECT_GT(shape.value({7.5, 0, 0}), 0.5);
    EXPECT_LT(shape.value({5.5, 0, 0}), -0.5);
    EXPECT_NEAR(shape.value({-10, 0, 0}), 0, 0.05);  // the far side is as it was
}

}  // namespace
}  // namespace palpate

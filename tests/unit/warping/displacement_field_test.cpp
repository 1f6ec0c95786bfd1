// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/displacement_field.hpp"

#include <gtest/gtest.h>

#include "tests/unit/warping/oblique_scene.hpp"

namespace palpate {
namespace {

using namespace testing;

TEST(DisplacementField, IsExactForAnAffineField) {
    Mat3 slope;
    slope << 0.1, -0.2, 0.05, 0.03, 0.15, -0.1, 0.2, 0.02, -0.12;
    const auto affine = [&](const Vec3& x) { return Vec3(slope * x + Vec3(1, 2, 3)); };
    const Image<Vec3> field = sampled(oblique_grid(), affine);

    for (const Vec3& x : points_in(field.grid, 200, 0)) {
        EXPECT_LT((displacement_at(field, x) - affine(x)).norm(), 1e-10);
    }
}

TEST(DisplacementField, GoesOnWithItsBorderAndSaysSo) {
    const Image<Vec3> field = sampled(oblique_grid(), smooth_displacement);
    const PointMap map{field};
    const Vec3 half_out = field.grid.to_point(Vec3(-0.4, 3, 3));
    const Vec3 out = field.grid.to_point(Vec3(-7, 3, 3));

    EXPECT_LT((map.moved(half_out).point - half_out - field.at(0, 3, 3)).norm(), 1e-12);
    EXPECT_TRUE(map.moved(half_out).inside);
    EXPECT_LT((map.moved(out).point - out - field.at(0, 3, 3)).norm(), 1e-12);
    EXPECT_FALSE(map.moved(out).inside);
}

TEST(PointMap, InvertedTakesPointsBackToWhereTheyCameFrom) {
    const Image<Vec3> field = sampled(oblique_grid(), smooth_displacement);
    const PointMap there{field}, back{field, true};

    for (const Vec3& x : points_in(field.grid, 300, 0.02)) {
        const MovedPoint again = back.moved(there.moved(x).point);
        EXPECT_LT((again.point - x).norm(), 1e-4);
        EXPECT_TRUE(again.inside);
    }
}

TEST(PointMap, InvertedSaysWhereItFoundNothing) {
    const PointMap back{sampled(oblique_grid(), smooth_displacement), true};

    EXPECT_FALSE(back.moved(back.field.grid.to_point(Vec3(60, 5, 5))).inside);
}

TEST(PointMap, InvertedTellsFoldsFromTheOutside) {
    PointMap back{sampled(oblique_grid(), [](const Vec3&) { return Vec3(0, 0, 0); }), true};
    const ImageGrid& grid = back.field.grid;
    for (Index i = 0; i < grid.size[0]; ++i)  // all of a row move to its first voxel
        back.field.at(i, 8, 8) = grid.to_point(Vec3(0, 8, 8)) - grid.to_point(Vec3(i, 8, 8));

    int lost = 0;
    for (Index i = 0; i < grid.size[0]; ++i)
        lost += !back.moved(grid.to_point(Vec3(i, 8, 8))).found;
    EXPECT_GT(lost, 0);
    EXPECT_TRUE(back.moved(grid.to_point(Vec3(20, 15, 8))).found);
    const MovedPoint outside = back.moved(grid.to_point(Vec3(-9, 15, 8)));
    EXPECT_TRUE(outside.found);
    EXPECT_FALSE(outside.inside);
}

TEST(OriginOf, FindsItInAFieldSteeperThanOne) {
    ImageGrid grid;
    grid.size = {80, 3, 3};
    // du/dx reaches +1.2: plain fixed-point iteration diverges, x + u(x) is still one to one.
    const Image<Vec3> field = sampled(grid, [](const Vec3& x) {
        return Vec3(12.0 + 12.0 * std::tanh((x.x() - 30.0) / 10.0), 0, 0);
    });
    const Vec3 x(33.3, 1, 1);

    const Origin found = origin_of(field, x + displacement_at(field, x), Vec3(10, 1, 1), 1e-6);

    EXPECT_LT((found.point - x).norm(), 1e-5);
    EXPECT_LT(found.defect_mm, 1e-6);
}

}  // namespace
}  // namespace palpate

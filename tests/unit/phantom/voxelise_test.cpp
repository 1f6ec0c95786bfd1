// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/voxelise.hpp"

#include <gtest/gtest.h>

#include "tests/unit/phantom/hollow_block.hpp"

namespace palpate {
namespace {

/// Two cavities one cube apart and a solid organ in a box of 12 x 8 x 6 mm.
Index region_at(const Vec3& x) {
    const auto in_box = [&](double x0, double x1) {
        return x[0] > x0 && x[0] < x1 && x[1] > 2 && x[1] < 6 && x[2] > 2 && x[2] < 5;
    };
    if (in_box(1, 4)) return 3;
    if (in_box(5, 7)) return 4;
    return in_box(8, 10) ? 2 : background_region;
}

RegionMesh two_cavities() {
    return fixtures::region_block({12, 8, 6}, Vec3(12, 8, 6), region_at, {3, 4});
}

ImageGrid half_millimetre_grid(Index margin) {
    ImageGrid grid;
    grid.size = {24 + 2 * margin, 16, 12};
    grid.spacing = Vec3(0.5, 0.5, 0.5);
    grid.origin = Vec3(0.25 - 0.5 * margin, 0.25, 0.25);
    return grid;
}

TEST(RegionsOnGrid, GivesEveryCavityItsOwnRegion) {
    const RegionMesh block = two_cavities();
    const ImageGrid grid = half_millimetre_grid(0);

    const RegionImage image = regions_on_grid(block, block.mesh.nodes, {3, 4}, grid);

    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i)
                ASSERT_EQ(image.at(i, j, k), region_at(grid.to_point(Vec3(i, j, k))));
}

TEST(RegionsOnGrid, FollowsTheDeformedWalls) {
    const RegionMesh block = two_cavities();
    const ImageGrid grid = half_millimetre_grid(0);
    std::vector<Vec3> moved = block.mesh.nodes;
    const auto stretch = [](double x) { return x + 0.1 * x * (12 - x) / 6; };
    for (Vec3& x : moved) x[0] = stretch(x[0]);

    const RegionImage image = regions_on_grid(block, moved, {3, 4}, grid);

    for (Index i = 0; i < grid.size[0]; ++i) {
        const double x = grid.to_point(Vec3(i, 8, 7))[0];
        const int expected = x < stretch(1)    ? 1
                             : x < stretch(4)  ? 3
                             : x < stretch(5)  ? 1
                             : x < stretch(7)  ? 4
                             : x < stretch(8)  ? 1
                             : x < stretch(10) ? 2
                                               : 1;
        EXPECT_EQ(image.at(i, 8, 7), expected) << x;
    }
}

TEST(RegionsOnGrid, TakesVoxelsBeyondTheBoxForBackground) {
    const RegionMesh block = two_cavities();
    const ImageGrid grid = half_millimetre_grid(3);

    const RegionImage image = regions_on_grid(block, block.mesh.nodes, {3, 4}, grid);

    for (Index i : {0, 1, 2, 27, 28, 29}) EXPECT_EQ(image.at(i, 8, 7), background_region);
    EXPECT_EQ(image.at(3 + 4, 8, 7), 3);
}

}  // namespace
}  // namespace palpate

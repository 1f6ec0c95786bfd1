// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/region_fill.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate::mesh_tool {
namespace {

/// Two tets on either side of the triangle (1, 2, 3).
const std::vector<Tet> two_tets{{0, 1, 2, 3}, {1, 2, 3, 4}};
const std::vector<Triangle> wall{{1, 2, 3}};

Mesh two_tet_mesh() {
    Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, two_tets, {7, 3}};
    EXPECT_GT(tet_volume(mesh, 0), 0);
    EXPECT_GT(tet_volume(mesh, 1), 0);
    return mesh;
}

TEST(RegionFill, puts_the_first_region_behind_the_triangle) {
    // (1, 2, 3) is counter-clockwise seen from node 4: tet 0 lies behind
    EXPECT_EQ(fill_regions(two_tets, wall, {{7, 3}}), (std::vector<Index>{7, 3}));
    EXPECT_EQ(fill_regions(two_tets, {{1, 3, 2}}, {{7, 3}}), (std::vector<Index>{3, 7}));
    EXPECT_EQ(fill_regions(two_tets, {{3, 1, 2}}, {{7, 3}}), (std::vector<Index>{7, 3}));
}

TEST(RegionFill, crosses_faces_that_are_no_triangles) {
    const std::vector<Triangle> hull{{0, 2, 1}};
    std::vector<Index> part;
    EXPECT_EQ(fill_regions(two_tets, hull, {{5, 0}}, &part), (std::vector<Index>{5, 5}));
    EXPECT_EQ(part, (std::vector<Index>{0, 0}));
}

TEST(RegionFill, refuses_sides_that_disagree) {
    EXPECT_THROW(fill_regions(two_tets, {{0, 2, 1}, {2, 3, 4}}, {{5, 0}, {6, 0}}), Error);
}

TEST(RegionFill, refuses_a_triangle_that_is_no_face) {
    EXPECT_THROW(fill_regions(two_tets, {{0, 1, 4}}, {{5, 0}}), Error);
}

TEST(RegionFill, refuses_tets_without_a_known_region) {
    const std::vector<Tet> apart{{0, 1, 2, 3}, {5, 6, 7, 8}};
    EXPECT_THROW(fill_regions(apart, {{0, 2, 1}}, {{5, 0}}), Error);
}

TEST(Interfaces, point_from_the_larger_region_and_lie_between_the_two) {
    std::vector<Triangle> triangles;
    std::vector<std::array<Index, 2>> regions;
    const Mesh mesh = two_tet_mesh();
    interfaces_between_regions(mesh, triangles, regions);
    ASSERT_EQ(triangles.size(), 7u);
    EXPECT_EQ(fill_regions(mesh.tets, triangles, regions), mesh.region);
    EXPECT_EQ(std::count(regions.begin(), regions.end(), std::array<Index, 2>{7, 3}), 1);
    EXPECT_EQ(std::count(regions.begin(), regions.end(), std::array<Index, 2>{7, 0}), 3);
}

}  // namespace
}  // namespace palpate::mesh_tool

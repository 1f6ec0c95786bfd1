// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/geometry/surfaces/picture_surface.hpp"
#include "tests/unit/surfaces/analytic_surfaces.hpp"

namespace palpate {
namespace {

/// Two tetrahedra that share the face 0 1 2: region 2 above it (vertex 3), region 3 below (vertex
/// 4). The last triangle lies on the image border.
RegionSurface two_tets() {
    RegionSurface all;
    all.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -2}};
    all.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
    all.regions = {{3, 2}, {2, 1}, {2, 1}, {2, 1}, {3, 1}, {3, 1}, {3, 0}};
    all.on_image_border = {0, 0, 0, 0, 0, 0, 1};
    return all;
}

TEST(Surface, OfARegionIsClosedAndPointsOutward) {
    EXPECT_NEAR(enclosed_volume(surface_of_region(two_tets(), 2)), 1.0 / 6, 1e-15);
    EXPECT_NEAR(enclosed_volume(surface_of_region(two_tets(), 3)), 2.0 / 6, 1e-15);
}

TEST(Surface, LeavesOutTheImageBorderWhenAsked) {
    EXPECT_EQ(surface_of_region(two_tets(), 3, true).triangles.size(), 4u);
    EXPECT_EQ(surface_of_region(two_tets(), 3, false).triangles.size(), 3u);
}

TEST(Surface, RemembersTheVerticesItCameFrom) {
    const RegionSurface all = two_tets();

    std::vector<Index> vertex_of{99};
    const Surface surface = surface_of_region(all, 2, true, &vertex_of);

    ASSERT_EQ(vertex_of.size(), surface.vertices.size());
    ASSERT_EQ(vertex_of.size(), 4u);
    for (std::size_t v = 0; v < vertex_of.size(); ++v) {
        EXPECT_EQ(all.vertices[vertex_of[v]], surface.vertices[v]);
    }
}

TEST(Surface, VolumeAndAreaOfASphereFarFromTheOrigin) {
    const Surface sphere = testing::sphere_surface(Vec3(1000, -2000, 500), 10, 200);

    EXPECT_NEAR(enclosed_volume(sphere), 4.0 / 3 * M_PI * 1000, 1);
    EXPECT_NEAR(surface_area(sphere), 4 * M_PI * 100, 0.2);
}

TEST(Surface, SharesAreaAmongTheVertices) {
    const Surface surface{{{0, 0, 0}, {6, 0, 0}, {0, 2, 0}, {0, 0, 3}, {9, 9, 9}},
                          {{0, 1, 2}, {0, 3, 1}}};

    // Triangles of 6 and 9 mm^2; the last vertex belongs to none.
    EXPECT_EQ(vertex_areas(surface), (std::vector<double>{5, 5, 2, 3, 0}));
}

TEST(PictureOfPoints, IsOneMarkTurnedOutwardForEachPointOfASmallCloud) {
    const Surface marks = picture_of_points({Vec3(0, 0, 0), Vec3(5, 0, 0), Vec3(0, 9, 1)}, 2.0);

    EXPECT_EQ(marks.triangles.size(), 24u);
    EXPECT_NEAR(enclosed_volume(marks), 3 * 4.0 / 3 * std::pow(0.8, 3), 1e-12);
}

TEST(PictureOfPoints, ThinsALargeCloud) {
    const Surface marks = picture_of_points(std::vector<Vec3>(50000, Vec3::Zero()), 1.0);
    EXPECT_LE(marks.triangles.size(), 8u * 4000);
}

TEST(VertexNormals, AverageTheTrianglesRoundAVertex) {
    const Surface roof{{Vec3(0, 0, 0), Vec3(0, 2, 0), Vec3(1, 0, -1), Vec3(-1, 0, -1)},
                       {{0, 2, 1}, {0, 1, 3}}};
    const auto normals = vertex_normals(roof);
    EXPECT_LT((normals[0] - Vec3(0, 0, 1)).norm(), 1e-12);
    EXPECT_LT((normals[2] - Vec3(1, 0, 1).normalized()).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "host/geometry/meshing/mesh_checks.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "tests/unit/meshing/test_surfaces.hpp"
#include "tests/unit/meshing/test_volumes.hpp"

namespace palpate {
namespace {

using testing::plain_image;

RegionMesh tetgen_mesh(const RegionSurface& surface, const std::vector<Index>& hollow,
                       MesherOptions options = {}, MesherSummary* summary = nullptr) {
    const RegionImage image = plain_image();
    const LabelField field(image, 2);
    options.kind = MesherKind::tetgen;
    return make_mesh(surface, image, field, hollow, options, summary);
}

std::array<double, 9> corners(const RegionSurface& surface, Index i) {
    std::array<double, 9> values{};
    for (int k = 0; k < 3; ++k)
        Vec3::Map(values.data() + 3 * k) = surface.vertices[surface.triangles[i][k]];
    return values;
}

class TetgenMesher : public ::testing::Test {
protected:
    void SetUp() override {
        for (const std::string& name : available_meshers())
            if (name.rfind("TetGen", 0) == 0) return;
        GTEST_SKIP() << "palpate-mesh was built without TetGen";
    }
};

TEST_F(TetgenMesher, keeps_every_triangle_of_the_surface_in_place_and_order) {
    const RegionSurface surface = testing::sphere_pelvis(2);
    const RegionMesh result = tetgen_mesh(surface, {});
    ASSERT_EQ(result.surface.num_triangles(), surface.num_triangles());
    for (Index i = 0; i < surface.num_triangles(); ++i) {
        EXPECT_EQ(corners(result.surface, i), corners(surface, i));
        EXPECT_EQ(result.surface.regions[i], surface.regions[i]);
        EXPECT_EQ(result.surface.on_image_border[i], surface.on_image_border[i]);
    }
    EXPECT_EQ(result.surface.vertices, result.mesh.nodes);
}

TEST_F(TetgenMesher, fills_nested_regions_to_the_volume_of_their_surfaces) {
    const RegionSurface surface = testing::sphere_pelvis(2);
    MesherSummary summary;
    tetgen_mesh(surface, {}, {}, &summary);
    const std::vector<double> expected = enclosed_volumes(surface, 6);
    for (Index r = 1; r < 6; ++r)
        EXPECT_NEAR(summary.quality.region_volume_mm3[r], expected[r], 1e-9 * expected[r]) << r;
    EXPECT_EQ(summary.quality.num_inverted, 0);
    EXPECT_GE(summary.quality.min_dihedral_deg, 5);
    EXPECT_EQ(summary.fallback, "");
}

TEST_F(TetgenMesher, leaves_hollow_regions_empty_and_drops_their_nodes) {
    const RegionSurface surface = testing::sphere_pelvis(2);
    const RegionMesh result = tetgen_mesh(surface, {3, 4});
    const std::set<Index> regions(result.mesh.region.begin(), result.mesh.region.end());
    EXPECT_EQ(regions, (std::set<Index>{1, 2, 5}));
    EXPECT_EQ(result.surface.num_triangles(), surface.num_triangles());
    for (const Vec3& node : result.mesh.nodes)
        EXPECT_GT((node - Vec3(60, 50, 88)).norm(), 23 - 1e-9);
    EXPECT_EQ(
        why_unusable(result, mesh_quality(result.mesh, 6), enclosed_volumes(surface, 6), {3, 4}),
        "");
}

TEST_F(TetgenMesher, drops_walls_between_two_hollow_regions_with_their_nodes) {
    const RegionSurface surface = testing::touching_boxes({2, 3, 4, 5}, 4, 20);
    const RegionMesh result = tetgen_mesh(surface, {3, 4});
    for (const auto& sides : result.surface.regions)
        EXPECT_TRUE(is_meshed_region(sides[0], {3, 4}) || is_meshed_region(sides[1], {3, 4}));
    EXPECT_EQ(result.surface.num_triangles(), 2 * 6 * 32);  // the two boxes that are left
    for (const Vec3& node : result.mesh.nodes) EXPECT_TRUE(node.x() <= 20 || node.x() >= 60);
}

TEST_F(TetgenMesher, shares_the_wall_of_touching_regions) {
    const RegionSurface surface = testing::touching_boxes({2, 3}, 4, 20);
    const RegionMesh result = tetgen_mesh(surface, {});
    for (Index t = 0; t < result.mesh.num_tets(); ++t) {
        Vec3 centre = Vec3::Zero();
        for (Index node : result.mesh.tets[t]) centre += result.mesh.nodes[node] / 4;
        EXPECT_EQ(result.mesh.region[t], centre.x() < 20 ? 2 : 3);
    }
}

TEST_F(TetgenMesher, leaves_an_outside_pocket_inside_the_domain_empty) {
    RegionSurface surface;
    testing::add_box(surface, Vec3::Zero(), Vec3::Constant(40), {5, 5, 5}, 1, outside_region);
    testing::add_sphere(surface, {20, 20, 20}, 10, 2, outside_region, 1);
    const RegionMesh result = tetgen_mesh(surface, {});
    for (const Vec3& node : result.mesh.nodes)
        EXPECT_GT((node - Vec3(20, 20, 20)).norm(), 10 - 1e-9);
}

TEST_F(TetgenMesher, meets_the_wanted_number_of_nodes_within_20_percent) {
    const RegionSurface surface = testing::sphere_pelvis(2);
    for (Index wanted : {2500, 6000, 12000}) {
        MesherOptions options;
        options.num_nodes = wanted;
        MesherSummary summary;
        tetgen_mesh(surface, {3, 4}, options, &summary);
        EXPECT_NEAR(summary.quality.num_nodes, wanted, 0.2 * wanted);
    }
}

TEST_F(TetgenMesher, gives_the_same_mesh_twice) {
    const RegionSurface surface = testing::sphere_pelvis(1);
    const RegionMesh a = tetgen_mesh(surface, {3}), b = tetgen_mesh(surface, {3});
    EXPECT_EQ(a.mesh.nodes, b.mesh.nodes);
    EXPECT_EQ(a.mesh.tets, b.mesh.tets);
    EXPECT_EQ(a.mesh.region, b.mesh.region);
}

}  // namespace
}  // namespace palpate

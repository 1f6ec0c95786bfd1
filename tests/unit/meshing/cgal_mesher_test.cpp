// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "host/geometry/meshing/mesh_checks.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "tests/unit/meshing/test_volumes.hpp"

namespace palpate {
namespace {

using testing::Ball;

RegionMesh cgal_mesh(const RegionImage& image, Index num_regions, const std::vector<Index>& hollow,
                     MesherOptions options = {}, MesherSummary* summary = nullptr) {
    const LabelField field(image, num_regions);
    options.kind = MesherKind::cgal;
    return make_mesh({}, image, field, hollow, options, summary);
}

MesherOptions coarse() {
    MesherOptions options;
    options.num_nodes = 1500;
    options.edge_length_mm = 5;
    return options;
}

class CgalMesher : public ::testing::Test {
protected:
    void SetUp() override {
        for (const std::string& name : available_meshers())
            if (name.rfind("CGAL", 0) == 0) return;
        GTEST_SKIP() << "palpate-mesh was built without CGAL";
    }
};

TEST_F(CgalMesher, meshes_nested_and_separate_regions_to_the_volume_of_their_voxels) {
    const RegionImage image = testing::ball_image(120, 2, testing::pelvis_balls());
    MesherOptions options;
    options.num_nodes = 4000;
    MesherSummary summary;
    const RegionMesh result = cgal_mesh(image, 6, {}, options, &summary);
    const std::vector<double> expected = voxel_volumes(image, 6);
    for (Index r = 1; r < 6; ++r)
        EXPECT_NEAR(summary.quality.region_volume_mm3[r], expected[r], 0.05 * expected[r]) << r;
    EXPECT_GE(summary.quality.min_dihedral_deg, 5);
    EXPECT_NEAR(summary.quality.num_nodes, 4000, 800);
}

TEST_F(CgalMesher, keeps_the_image_box_exactly) {
    const RegionImage image = testing::ball_image(60, 2, {{{30, 30, 30}, 12, 2}});
    const RegionMesh result = cgal_mesh(image, 3, {}, coarse());
    double volume = 0, border = 0;
    for (Index t = 0; t < result.mesh.num_tets(); ++t) volume += tet_volume(result.mesh, t);
    EXPECT_NEAR(volume, 60 * 60 * 60, 1e-6);
    for (Index i = 0; i < result.surface.num_triangles(); ++i) {
        const auto& sides = result.surface.regions[i];
        EXPECT_EQ(result.surface.on_image_border[i] == 1, sides[1] == outside_region);
        const auto& [a, b, c] = result.surface.triangles[i];
        const auto& nodes = result.mesh.nodes;
        if (sides[1] == outside_region)
            border += 0.5 * (nodes[b] - nodes[a]).cross(nodes[c] - nodes[a]).norm();
    }
    EXPECT_NEAR(border, 6 * 60 * 60, 1e-6);
}

TEST_F(CgalMesher, leaves_hollow_regions_empty) {
    const RegionImage image =
        testing::ball_image(60, 2, {{{30, 30, 30}, 14, 2}, {{30, 30, 30}, 7, 3}});
    const RegionMesh result = cgal_mesh(image, 4, {2}, coarse());
    const std::set<Index> regions(result.mesh.region.begin(), result.mesh.region.end());
    EXPECT_EQ(regions, (std::set<Index>{1, 3}));
    EXPECT_EQ(why_unusable(result, mesh_quality(result.mesh, 4), voxel_volumes(image, 4), {2}), "");
}

TEST_F(CgalMesher, finds_every_one_of_many_small_islands) {
    std::vector<Ball> balls;
    for (int i = 0; i < 8; ++i)
        balls.push_back(
            {Vec3(15 + 30 * (i & 1), 15 + 30 * ((i >> 1) & 1), 15 + 30 * (i >> 2)), 5, 2});
    const RegionImage image = testing::ball_image(60, 1.5, balls);
    MesherOptions options = coarse();
    options.num_nodes = 3000;
    options.edge_length_mm = 3;
    EXPECT_NO_THROW(cgal_mesh(image, 3, {}, options));
}

TEST_F(CgalMesher, caps_an_organ_that_the_image_cuts) {
    const RegionImage image = testing::ball_image(60, 2, {{{30, 30, 4}, 15, 2}});
    const RegionMesh result = cgal_mesh(image, 3, {}, coarse());
    int caps = 0;
    for (Index i = 0; i < result.surface.num_triangles(); ++i)
        caps += result.surface.regions[i] == std::array<Index, 2>{2, 0} &&
                result.surface.on_image_border[i];
    EXPECT_GT(caps, 4);
}

TEST_F(CgalMesher, follows_oblique_and_left_handed_images) {
    Mat3 direction = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    direction.col(1) *= -1;
    const RegionImage image = testing::ball_image(60, 2, {{{20, 30, 40}, 12, 2}}, direction);
    const RegionMesh result = cgal_mesh(image, 3, {}, coarse());
    const Vec3 expected = image.grid.to_point(Vec3(20, 30, 40) / 2 - Vec3::Constant(0.5));
    Vec3 centre = Vec3::Zero();
    double volume = 0;
    for (Index t = 0; t < result.mesh.num_tets(); ++t) {
        if (result.mesh.region[t] != 2) continue;
        for (Index node : result.mesh.tets[t])
            centre += tet_volume(result.mesh, t) * result.mesh.nodes[node] / 4;
        volume += tet_volume(result.mesh, t);
    }
    EXPECT_LT((centre / volume - expected).norm(), 0.2);
    EXPECT_NEAR(enclosed_volumes(result.surface, 3)[2], volume, 1e-6 * volume);
}

TEST_F(CgalMesher, gives_the_same_mesh_twice) {
    const RegionImage image = testing::ball_image(60, 2, {{{30, 30, 30}, 12, 2}});
    const RegionMesh a = cgal_mesh(image, 3, {}, coarse()), b = cgal_mesh(image, 3, {}, coarse());
    EXPECT_EQ(a.mesh.nodes, b.mesh.nodes);
    EXPECT_EQ(a.mesh.tets, b.mesh.tets);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/mesh_checks.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

/// One tet of region 1 with its four faces against outside.
RegionMesh one_tet() {
    RegionMesh m;
    m.mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {1}};
    m.surface.vertices = m.mesh.nodes;
    m.surface.triangles = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    m.surface.regions.assign(4, {1, 0});
    m.surface.on_image_border.assign(4, 0);
    return m;
}

std::string verdict(const RegionMesh& m, double expected_mm3 = 1.0 / 6) {
    return why_unusable(m, mesh_quality(m.mesh, 2), {0, expected_mm3}, {});
}

TEST(MeshChecks, accept_a_sound_mesh) {
    EXPECT_EQ(verdict(one_tet()), "");
    EXPECT_TRUE(has_valid_indices(one_tet()));
    EXPECT_NEAR(enclosed_volumes(one_tet().surface, 2)[1], 1.0 / 6, 1e-15);
}

TEST(MeshChecks, refuse_a_wrong_volume) {
    EXPECT_EQ(verdict(one_tet(), 1.04 / 6), "");
    EXPECT_NE(verdict(one_tet(), 1.06 / 6).find("region 1"), std::string::npos);
}

TEST(MeshChecks, refuse_an_open_surface) {
    RegionMesh m = one_tet();
    m.surface.triangles.pop_back();
    m.surface.regions.pop_back();
    EXPECT_NE(verdict(m).find("open"), std::string::npos);
}

TEST(MeshChecks, refuse_an_inverted_tet) {
    RegionMesh m = one_tet();
    std::swap(m.mesh.tets[0][0], m.mesh.tets[0][1]);
    EXPECT_NE(verdict(m).find("inverted"), std::string::npos);
}

TEST(MeshChecks, refuse_a_sliver) {
    RegionMesh m = one_tet();
    m.mesh.nodes[3] = {0.3, 0.3, 0.01};
    EXPECT_NE(verdict(m).find("dihedral"), std::string::npos);
}

TEST(MeshChecks, refuse_unused_nodes_and_bad_indices) {
    RegionMesh m = one_tet();
    m.mesh.nodes.push_back({9, 9, 9});
    EXPECT_NE(verdict(m).find("belong to no tet"), std::string::npos);
    m.mesh.tets[0][2] = 5;
    EXPECT_FALSE(has_valid_indices(m));
    m.mesh.tets[0][2] = -1;
    EXPECT_FALSE(has_valid_indices(m));
}

}  // namespace
}  // namespace palpate

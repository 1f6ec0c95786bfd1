// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/geometry/meshing/mesher.hpp"

namespace palpate {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

Mesh corner_tet() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {1}}; }

TEST(MeshQuality, of_a_regular_tet_has_one_dihedral_angle) {
    Mesh mesh = corner_tet();
    mesh.nodes = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    if (tet_volume(mesh, 0) < 0) std::swap(mesh.tets[0][2], mesh.tets[0][3]);
    const MeshQuality quality = mesh_quality(mesh, 2);
    EXPECT_NEAR(quality.min_dihedral_deg, std::acos(1.0 / 3) * degrees, 1e-10);
    EXPECT_NEAR(quality.max_dihedral_deg, std::acos(1.0 / 3) * degrees, 1e-10);
    EXPECT_NEAR(quality.region_volume_mm3[1], 8.0 / 3, 1e-12);
}

TEST(MeshQuality, of_a_cube_corner_has_right_and_flat_angles) {
    const MeshQuality quality = mesh_quality(corner_tet(), 2);
    EXPECT_NEAR(quality.max_dihedral_deg, 90, 1e-10);
    EXPECT_NEAR(quality.min_dihedral_deg, std::acos(1 / std::sqrt(3.0)) * degrees, 1e-10);
    EXPECT_NEAR(quality.min_volume_mm3, 1.0 / 6, 1e-15);
    EXPECT_EQ(quality.num_inverted, 0);
}

TEST(MeshQuality, finds_the_thin_edge_of_a_sliver) {
    Mesh mesh = corner_tet();
    mesh.nodes = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0.01}, {0, -1, 0.01}};
    if (tet_volume(mesh, 0) < 0) std::swap(mesh.tets[0][2], mesh.tets[0][3]);
    const MeshQuality quality = mesh_quality(mesh, 2);
    EXPECT_NEAR(quality.max_dihedral_deg, 180 - 2 * std::atan(0.01) * degrees, 1e-6);
    EXPECT_LT(quality.min_dihedral_deg, 1.0);
}

TEST(MeshQuality, counts_inverted_tets) {
    Mesh mesh = corner_tet();
    mesh.tets.push_back({0, 2, 1, 3});
    mesh.region.push_back(1);
    EXPECT_EQ(mesh_quality(mesh, 2).num_inverted, 1);
    EXPECT_EQ(mesh_quality(Mesh{}, 2).num_tets, 0);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/node_mover.hpp"

#include <gtest/gtest.h>

#include "host/geometry/mesh_tool/region_fill.hpp"
#include "host/geometry/meshing/mesher.hpp"

namespace palpate::mesh_tool {
namespace {

/// An octahedron cut into eight tets round a middle node.
Mesh octahedron(const Vec3& middle) {
    Mesh mesh;
    mesh.nodes = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, middle};
    for (Index x : {0, 1})
        for (Index y : {2, 3})
            for (Index z : {4, 5}) {
                mesh.tets.push_back({x, y, z, 6});
                Tet& tet = mesh.tets.back();
                if (tet_volume(mesh, mesh.num_tets() - 1) < 0) std::swap(tet[0], tet[1]);
            }
    mesh.region.assign(8, 1);
    return mesh;
}

std::vector<Triangle> hull(const Mesh& mesh) {
    std::vector<Triangle> triangles;
    std::vector<std::array<Index, 2>> regions;
    interfaces_between_regions(mesh, triangles, regions);
    return triangles;
}

TEST(NodeMover, moves_an_inner_node_out_of_a_sliver_and_keeps_the_surface) {
    Mesh mesh = octahedron({0.3, 0.3, 0.37});
    const Mesh before = mesh;
    ASSERT_LT(mesh_quality(mesh, 2).min_dihedral_deg, 6);
    move_nodes_of_slivers(mesh, hull(mesh), SurfaceNodes::fixed, 30);
    EXPECT_GT(mesh_quality(mesh, 2).min_dihedral_deg, 29);
    EXPECT_EQ(mesh_quality(mesh, 2).num_inverted, 0);
    for (int n = 0; n < 6; ++n) EXPECT_EQ(mesh.nodes[n], before.nodes[n]);
}

TEST(NodeMover, leaves_a_good_mesh_alone) {
    Mesh mesh = octahedron({0, 0, 0});
    const Mesh before = mesh;
    move_nodes_of_slivers(mesh, hull(mesh), SurfaceNodes::slide, 20);
    EXPECT_EQ(mesh.nodes, before.nodes);
}

/// A tall pyramid on the plane z = 0 whose base is cut into four round a node of the plane.
TEST(NodeMover, slides_surface_nodes_within_their_plane_only) {
    Mesh mesh;
    mesh.nodes = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0, 0, 1}, {0.9, 0, 0}};
    mesh.tets = {{0, 1, 5, 4}, {1, 2, 5, 4}, {2, 3, 5, 4}, {3, 0, 5, 4}};
    for (Index t = 0; t < 4; ++t)
        if (tet_volume(mesh, t) < 0) std::swap(mesh.tets[t][0], mesh.tets[t][1]);
    mesh.region.assign(4, 1);
    const std::vector<Vec3> before = mesh.nodes;
    const double angle = mesh_quality(mesh, 2).min_dihedral_deg;
    move_nodes_of_slivers(mesh, hull(mesh), SurfaceNodes::slide, 40);
    EXPECT_GT(mesh_quality(mesh, 2).min_dihedral_deg, angle + 1);
    EXPECT_NEAR(mesh.nodes[5].z(), 0, 1e-15);
    for (int n = 0; n < 5; ++n) EXPECT_EQ(mesh.nodes[n], before[n]);
}

}  // namespace
}  // namespace palpate::mesh_tool

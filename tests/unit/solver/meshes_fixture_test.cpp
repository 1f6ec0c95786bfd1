// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

double total_volume(const Mesh& mesh) {
    double volume = 0;
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        EXPECT_GT(tet_volume(mesh, t), 0);
        volume += tet_volume(mesh, t);
    }
    return volume;
}

TEST(BoxMesh, FillsTheBoxWithSixTetsPerCube) {
    const Mesh mesh = fixtures::box_mesh({3, 2, 4}, {6, 5, 7});

    EXPECT_EQ(mesh.num_nodes(), 4 * 3 * 5);
    EXPECT_EQ(mesh.num_tets(), 6 * 24);
    EXPECT_NEAR(total_volume(mesh), 6 * 5 * 7, 1e-11);
    // Conforming: only the nodes on the outside are on faces with one tet.
    EXPECT_EQ(fixtures::boundary_nodes(mesh).size(), 60u - 2 * 1 * 3);
}

TEST(OctantShellMesh, FillsTheOctantBetterTheFinerItIs) {
    const double exact = 4.0 / 3 * std::numbers::pi * (1000 - 125) / 8;

    const double coarse = exact - total_volume(fixtures::octant_shell_mesh(4, 2, 5, 10));
    const double fine = exact - total_volume(fixtures::octant_shell_mesh(8, 2, 5, 10));

    EXPECT_GT(coarse, 0);
    EXPECT_LT(coarse, 0.1 * exact);
    EXPECT_NEAR(coarse / fine, 4, 0.5);
}

TEST(OctantShellMesh, IsConforming) {
    const Index n = 6, layers = 3;
    const Mesh mesh = fixtures::octant_shell_mesh(n, layers, 5, 10);

    const Index per_layer = (n + 1) * (n + 2) / 2;
    const Index inner_per_layer = (n - 1) * (n - 2) / 2;
    EXPECT_EQ(mesh.num_nodes(), per_layer * (layers + 1));
    EXPECT_EQ(fixtures::boundary_nodes(mesh).size(),
              static_cast<std::size_t>(mesh.num_nodes() - inner_per_layer * (layers - 1)));
}

TEST(InterfaceNodes, LieBetweenTwoRegions) {
    Mesh mesh = fixtures::box_mesh({4, 4, 4}, {4, 4, 4});
    fixtures::set_inclusion(mesh, [](const Vec3& p) { return p.z() > 2; });

    const std::vector<Index> nodes = fixtures::interface_nodes(mesh);

    EXPECT_EQ(nodes.size(), 25u);
    for (Index n : nodes) EXPECT_EQ(mesh.nodes[n].z(), 2);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/curved_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/apps/phantom/deform.hpp"
#include "tests/unit/phantom/hollow_block.hpp"

namespace palpate {
namespace {

constexpr double box_mm = 40, middle_mm = 20;
constexpr Index below = background_region, above = first_organ_region;

/// Height of the interface between the two regions, mm.
double height_at(double x) { return middle_mm + 3 * std::sin(M_PI * x / box_mm); }

LabelField field_of_interface() {
    RegionImage image;
    image.grid.size = {80, 80, 80};
    image.grid.spacing = Vec3::Constant(0.5);
    image.grid.origin = 0.5 * image.grid.spacing;
    for (Index k = 0; k < 80; ++k)
        for (Index j = 0; j < 80; ++j)
            for (Index i = 0; i < 80; ++i) {
                const Vec3 x = image.grid.to_point(Vec3(i, j, k));
                image.voxels.push_back(x[2] > height_at(x[0]) ? above : below);
            }
    return LabelField(image, 3);
}

/// Cells of 10 mm whose layers are bent along the interface, straight between its corners.
RegionMesh bent_block() {
    RegionMesh block =
        fixtures::region_block({4, 4, 4}, Vec3::Constant(box_mm),
                               [](const Vec3& x) { return x[2] > middle_mm ? above : below; }, {});
    for (Vec3& x : block.mesh.nodes)
        x[2] += (height_at(x[0]) - middle_mm) * (1 - std::abs(x[2] - middle_mm) / middle_mm);
    block.surface.vertices = block.mesh.nodes;
    return block;
}

TEST(CurvedMesh, FollowsTheInterfaceBetweenTheCorners) {
    const LabelField field = field_of_interface();
    const BodyMesh straight = body_mesh(bent_block(), ElementType::tet10);

    const BodyMesh curved = curved_along(field, straight);

    const Index num_corners = bent_block().mesh.num_nodes();
    ASSERT_EQ(curved.mesh.num_nodes(), straight.mesh.num_nodes());
    EXPECT_EQ(curved.surface.vertices, curved.mesh.nodes);
    EXPECT_EQ(curved.mesh.elements, straight.mesh.elements);
    double farthest = 0;
    int on_interface = 0;
    for (Index n = 0; n < curved.mesh.num_nodes(); ++n) {
        const Vec3 &x = curved.mesh.nodes[n], &before = straight.mesh.nodes[n];
        if (x == before) continue;
        EXPECT_GE(n, num_corners);
        EXPECT_LT(std::abs(field.interface_value(below, above, x)), 1e-3);
        EXPECT_LT(std::abs(x[2] - height_at(x[0])), 0.2);
        farthest = std::max(farthest, (x - before).norm());
        ++on_interface;
    }
    EXPECT_GT(on_interface, 20);
    EXPECT_GT(farthest, 0.15);  // the sagitta of 10 mm at the top: 3 pi^2 10^2 / (8 40^2) = 0.23
    EXPECT_LT(farthest, 0.4);
}

TEST(CurvedMesh, LeavesLinearElementsAndCrushedOnesAsTheyWere) {
    const LabelField field = field_of_interface();
    const BodyMesh linear = body_mesh(bent_block(), ElementType::tet4);
    EXPECT_EQ(curved_along(field, linear).mesh.nodes, linear.mesh.nodes);

    // With the corners 9 mm below the interface its nodes would go through the cells above.
    RegionMesh sunk = bent_block();
    for (Vec3& x : sunk.mesh.nodes) x[2] -= 9 * (1 - std::abs(x[2] - middle_mm) / middle_mm);
    sunk.surface.vertices = sunk.mesh.nodes;
    const BodyMesh straight = body_mesh(sunk, ElementType::tet10);

    const BodyMesh curved = curved_along(field, straight);

    const Mesh pieces = linear_pieces_of(curved).mesh, before = linear_pieces_of(straight).mesh;
    for (Index t = 0; t < pieces.num_tets(); ++t)
        EXPECT_GE(tet_volume(pieces, t), 0.33 * tet_volume(before, t));
    int left = 0;  // though the interface is some 9 mm away
    for (const auto& triangle : straight.surface.triangles)
        for (const Index node : triangle)
            left += node >= sunk.mesh.num_nodes() &&
                    field.interface_value(below, above, curved.mesh.nodes[node]) < -5;
    EXPECT_GT(left, 0);
}

}  // namespace
}  // namespace palpate

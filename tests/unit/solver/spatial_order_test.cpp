// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/mesh/spatial_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

TEST(SpatialOrder, VisitsTheCornersOfACubeOctantByOctant) {
    const std::vector<Vec3> corners = {{1, 1, 1}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}};

    EXPECT_EQ(spatial_order(corners), (std::vector<Index>{1, 3, 2, 0}));
    EXPECT_TRUE(spatial_order({}).empty());
    EXPECT_EQ(spatial_order({{5, 5, 5}, {5, 5, 5}}), (std::vector<Index>{0, 1}));
}

TEST(Renumbered, IsTheSameMesh) {
    const Model model = fixtures::two_tissue_model({4, 3, 5});
    const std::vector<Index> order = spatial_order(model.mesh.nodes);

    const Mesh mesh = renumbered(model.mesh, order);

    ASSERT_EQ(mesh.num_nodes(), model.mesh.num_nodes());
    ASSERT_EQ(mesh.num_tets(), model.mesh.num_tets());
    std::vector<std::pair<Tet, Index>> before, after;
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        before.emplace_back(model.mesh.tets[t], model.mesh.region[t]);
        Tet tet = mesh.tets[t];
        for (Index& node : tet) node = order[node];
        after.emplace_back(tet, mesh.region[t]);
        EXPECT_GT(tet_volume(mesh, t), 0);
    }
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace palpate

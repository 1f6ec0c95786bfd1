// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/mesh/node_elements.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

/// Two tets that share the face 1 2 3; node 5 belongs to none.
Mesh two_tets() {
    Mesh mesh;
    mesh.nodes.resize(6, Vec3::Zero());
    mesh.tets = {{0, 1, 2, 3}, {4, 3, 2, 1}};
    mesh.region = {0, 0};
    return mesh;
}

TEST(CornersOfNodes, ListsTheCornersOfEveryNodeInAscendingOrder) {
    const Adjacency corners = corners_of_nodes(two_tets());

    EXPECT_EQ(corners.offsets, (std::vector<Index>{0, 1, 3, 5, 7, 8, 8}));
    EXPECT_EQ(corners.items, (std::vector<Index>{0, 1, 7, 2, 6, 3, 5, 4}));
}

TEST(NodeGraph, ListsTheNodeItselfAndItsNeighbours) {
    const Adjacency graph = node_graph(two_tets());

    ASSERT_EQ(graph.num_lists(), 6);
    EXPECT_EQ(graph.offsets, (std::vector<Index>{0, 4, 9, 14, 19, 23, 24}));
    EXPECT_EQ(std::vector<Index>(graph.items.begin(), graph.items.begin() + 9),
              (std::vector<Index>{0, 1, 2, 3, 0, 1, 2, 3, 4}));
    EXPECT_EQ(graph.items.back(), 5);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/model_tables.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

using Indices = std::vector<Index>;

// Two tets that share the face (1, 2, 3); node 5 belongs to none.
Mesh two_tets() {
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {9, 9, 9}};
    mesh.tets = {{0, 1, 2, 3}, {4, 1, 3, 2}};
    mesh.region = {1, 0};
    return mesh;
}

TEST(NodeCorners, ListTetAndCornerInAscendingOrder) {
    const RowTable corners = node_corners(two_tets());

    EXPECT_EQ(corners.start, (Indices{0, 1, 3, 5, 7, 8, 8}));
    EXPECT_EQ(corners.entry, (Indices{0, 1, 5, 2, 7, 3, 6, 4}));
}

TEST(BlockPattern, HoldsNeighboursAndTheNodeItself) {
    const Mesh mesh = two_tets();
    const RowTable pattern = block_pattern(mesh, node_corners(mesh));

    EXPECT_EQ(pattern.start, (Indices{0, 4, 9, 14, 19, 23, 24}));
    EXPECT_EQ(pattern.entry,
              (Indices{0, 1, 2, 3, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 1, 2, 3, 4, 5}));
}

TEST(CornerSlots, PointAtTheNodesOfTheTetInTheRow) {
    const Mesh mesh = fixtures::box_mesh({3, 2, 4}, {3, 2, 4});
    const RowTable corners = node_corners(mesh);
    const RowTable pattern = block_pattern(mesh, corners);

    const std::vector<std::uint16_t> slots = corner_slots(mesh, corners, pattern);

    ASSERT_EQ(slots.size(), 16 * mesh.tets.size());
    for (Index node = 0; node < mesh.num_nodes(); ++node)
        for (Index k = corners.start[node]; k < corners.start[node + 1]; ++k)
            for (int b = 0; b < 4; ++b)
                EXPECT_EQ(pattern.entry[pattern.start[node] + slots[4 * k + b]],
                          mesh.tets[corners.entry[k] / 4][b]);
}

TEST(RegionChunks, HoldEveryTetOnceAndOneRegionEach) {
    Mesh mesh = fixtures::box_mesh({3, 2, 4}, {3, 2, 4});
    for (Index t = 0; t < mesh.num_tets(); ++t) mesh.region[t] = (t * t) % 3;  // 0 and 1 only

    const RegionChunks chunks = region_chunks(mesh, 4, 7);

    Indices sorted = chunks.order;
    std::sort(sorted.begin(), sorted.end());
    for (Index t = 0; t < mesh.num_tets(); ++t) ASSERT_EQ(sorted[t], t);
    ASSERT_EQ(chunks.start.size(), chunks.region.size() + 1);
    EXPECT_EQ(chunks.start.back(), mesh.num_tets());
    for (std::size_t chunk = 0; chunk < chunks.region.size(); ++chunk) {
        EXPECT_LE(chunks.start[chunk + 1] - chunks.start[chunk], 7);
        for (Index k = chunks.start[chunk]; k < chunks.start[chunk + 1]; ++k)
            EXPECT_EQ(mesh.region[chunks.order[k]], chunks.region[chunk]);
    }
}

}  // namespace
}  // namespace palpate

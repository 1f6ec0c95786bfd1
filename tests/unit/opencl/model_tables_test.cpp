// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/model_tables.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

using Indices = std::vector<Index>;

TEST(CornerSlots, PointAtTheNodesOfTheTetInTheRow) {
    const Mesh mesh = fixtures::box_mesh({3, 2, 4}, {3, 2, 4});
    const Adjacency corners = corners_of_nodes(mesh);
    const Adjacency pattern = node_graph(mesh);

    const std::vector<std::uint16_t> slots = corner_slots(mesh, corners, pattern);

    ASSERT_EQ(slots.size(), 16 * mesh.tets.size());
    for (Index node = 0; node < mesh.num_nodes(); ++node)
        for (Index k = corners.offsets[node]; k < corners.offsets[node + 1]; ++k)
            for (int b = 0; b < 4; ++b)
                EXPECT_EQ(pattern.items[pattern.offsets[node] + slots[4 * k + b]],
                          mesh.tets[corners.items[k] / 4][b]);
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

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/element_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

SolidMesh box_of(Index cells) {
    return solid_mesh_of(fixtures::box_mesh({cells, cells, cells}, Vec3(2, 2, 2)));
}

std::vector<SolidMesh> meshes() {
    return {box_of(1), box_of(7), with_edge_nodes(box_of(4)),
            fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric, {30, 20},
                                     {3.0, 2.0})};
}

std::set<Index> nodes_of_part(const SolidMesh& mesh, const ElementParts& parts, Index part) {
    std::set<Index> nodes;
    for (Index k = parts.elements.offsets[part]; k < parts.elements.offsets[part + 1]; ++k)
        for (const Index node : mesh.nodes_of(parts.elements.items[k])) nodes.insert(node);
    return nodes;
}

TEST(ElementParts, EveryElementIsInOnePartAndEveryPartInOneColour) {
    for (const SolidMesh& mesh : meshes()) {
        const ElementParts parts = element_parts(mesh);
        for (const auto& [list, count] :
             {std::pair(parts.elements.items, mesh.num_elements()),
              std::pair(parts.parts.items, parts.elements.num_lists())}) {
            std::vector<Index> sorted = list;
            std::sort(sorted.begin(), sorted.end());
            ASSERT_EQ(static_cast<Index>(sorted.size()), count);
            for (Index k = 0; k < count; ++k) EXPECT_EQ(sorted[k], k);
        }
    }
}

TEST(ElementParts, NoTwoPartsOfAColourShareANode) {
    for (const SolidMesh& mesh : meshes()) {
        const ElementParts parts = element_parts(mesh);
        for (Index c = 0; c < parts.parts.num_lists(); ++c) {
            std::set<Index> seen;
            for (Index k = parts.parts.offsets[c]; k < parts.parts.offsets[c + 1]; ++k)
                for (const Index node : nodes_of_part(mesh, parts, parts.parts.items[k]))
                    EXPECT_TRUE(seen.insert(node).second) << mesh.table().name;
        }
    }
}

TEST(ElementParts, LargeMeshesHaveFewColoursOfManyParts) {
    const ElementParts parts = element_parts(box_of(20));

    EXPECT_GE(parts.elements.num_lists(), 128);
    EXPECT_LE(parts.parts.num_lists(), 40);
}

}  // namespace
}  // namespace palpate

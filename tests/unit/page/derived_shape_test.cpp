// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/derived_shape.hpp"

#include <gtest/gtest.h>

#include "tests/unit/page/shapes.hpp"

namespace palpate {
namespace {

TEST(Thinned, SmallCubesKeepAllTrianglesAndOnlyTheVerticesOfTriangles) {
    TriangleShape box = box_shape(4);
    const std::size_t count = box.vertices.size();
    box.vertices.insert(box.vertices.begin(), Vec3(9, 9, 9));
    for (Triangle& t : box.triangles)
        for (Index& v : t) ++v;

    const DerivedShape kept = thinned(box.vertices, box.triangles, 1e-3);

    EXPECT_EQ(kept.triangles.size(), box.triangles.size());
    EXPECT_EQ(kept.source.size(), count);
    EXPECT_EQ(std::count(kept.source.begin(), kept.source.end(), 0), 0);
}

TEST(Thinned, LargeCubesKeepTheShapeWithFewerTriangles) {
    const TriangleShape box = box_shape(16);

    const DerivedShape few = thinned(box.vertices, box.triangles, 0.26);

    EXPECT_LT(few.triangles.size(), box.triangles.size() / 4);
    const std::vector<Vec3> vertices = few.of(box.vertices);
    EXPECT_NEAR(area_of({vertices, few.triangles}), 6, 1.5);
    for (const Triangle& t : few.triangles) {
        EXPECT_NE(t[0], t[1]);
        EXPECT_NE(t[1], t[2]);
        EXPECT_NE(t[2], t[0]);
    }
}

TEST(ThinnedTo, KeepsBelowTheLimitAndEndsWhateverItIs) {
    const TriangleShape box = box_shape(16);

    for (const std::size_t most : {1000, 100, 1, 0})
        EXPECT_LE(thinned_to(most, box.vertices, box.triangles).triangles.size(), most);
    EXPECT_GT(thinned_to(1000, box.vertices, box.triangles).triangles.size(), 400u);
    EXPECT_TRUE(thinned_to(0, {Vec3(1, 2, 3)}, {{0, 0, 0}}).triangles.empty());
}

TEST(SplitAtCreases, ABoxHasSixSidesOfTheirOwnVertices) {
    const TriangleShape box = box_shape(3);

    const DerivedShape split = split_at_creases(box.vertices, box.triangles);

    EXPECT_EQ(split.source.size(), 6u * 4 * 4);
    for (std::size_t t = 0; t < box.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            EXPECT_EQ(split.source[split.triangles[t][k]], box.triangles[t][k]);
}

TEST(SplitAtCreases, AFlatOrGentlyBentSheetStaysWhole) {
    TriangleShape roof{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    EXPECT_EQ(split_at_creases(roof.vertices, roof.triangles).source.size(), 4u);
    roof.triangles[1] = {0, 3, 2};  // the other way round: a fold
    EXPECT_EQ(split_at_creases(roof.vertices, roof.triangles).source.size(), 6u);
}

}  // namespace
}  // namespace palpate

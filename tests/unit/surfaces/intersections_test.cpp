// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/intersections.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

using Pairs = std::vector<std::array<Index, 2>>;

Pairs pairs(std::vector<Vec3> vertices, std::vector<Triangle> triangles) {
    return find_intersections(vertices, triangles);
}

TEST(Intersections, TwoTrianglesThatPierceEachOtherAreFound) {
    const std::vector<Vec3> v{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}};

    EXPECT_EQ(pairs(v, {{0, 1, 2}, {3, 4, 5}}), (Pairs{{0, 1}}));
}

TEST(Intersections, TrianglesApartAreNotFoundEvenIfTheirBoxesOverlap) {
    const std::vector<Vec3> v{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 4, -1}, {4, 4, 1}, {3, 3, 1}};

    EXPECT_TRUE(pairs(v, {{0, 1, 2}, {3, 4, 5}}).empty());
}

TEST(Intersections, AVertexThatTouchesAnotherTriangleCounts) {
    const std::vector<Vec3> v{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 2, 3}, {2, 1, 3}};

    EXPECT_EQ(pairs(v, {{0, 1, 2}, {3, 4, 5}}).size(), 1u);
}

TEST(Intersections, NeighboursWithACommonEdgeMayBendButNotFoldOver) {
    std::vector<Vec3> v{{0, 0, 0}, {4, 0, 0}, {1, 3, 0}, {1, -3, 1}};
    const std::vector<Triangle> triangles{{0, 1, 2}, {1, 0, 3}};

    EXPECT_TRUE(pairs(v, triangles).empty());
    v[3] = {1, 2, 0.5};
    EXPECT_TRUE(pairs(v, triangles).empty());
    v[3] = {1, 2, 0};
    EXPECT_EQ(pairs(v, triangles).size(), 1u);
}

TEST(Intersections, NeighboursWithACommonVertexMayNotCrossBeyondIt) {
    std::vector<Vec3> v{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 2, 1}, {2, 2, 3}};
    const std::vector<Triangle> triangles{{0, 1, 2}, {0, 3, 4}};

    EXPECT_TRUE(pairs(v, triangles).empty());
    v[3] = {1, 1, -1};
    EXPECT_EQ(pairs(v, triangles).size(), 1u);
}

TEST(Intersections, TrianglesOfOnePlaneCrossOnlyWhereTheyOverlap) {
    std::vector<Vec3> v{{0, 0, 7}, {4, 0, 7}, {0, 4, 7}, {4, 4, 7}, {4, 1, 7}, {1, 4, 7}};
    const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};

    EXPECT_TRUE(pairs(v, triangles).empty());
    v[3] = {1, 1, 7};
    EXPECT_EQ(pairs(v, triangles).size(), 1u);
}

TEST(Intersections, TheGridFindsTheSamePairsAsComparingAll) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-20, 20), reach(-3, 3);
    std::vector<Vec3> v;
    std::vector<Triangle> triangles;
    for (Index t = 0; t < 300; ++t) {
        const Vec3 centre(place(random), place(random), place(random));
        for (int corner = 0; corner < 3; ++corner)
            v.push_back(centre + Vec3(reach(random), reach(random), reach(random)));
        triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }

    Pairs expected;
    for (Index a = 0; a < 300; ++a)
        for (Index b = a + 1; b < 300; ++b)
            if (!pairs(v, {triangles[a], triangles[b]}).empty()) expected.push_back({a, b});

    EXPECT_GT(expected.size(), 10u);
    EXPECT_EQ(pairs(v, triangles), expected);
}

}  // namespace
}  // namespace palpate

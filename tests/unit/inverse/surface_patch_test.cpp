// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/surface_patch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

/// A sheet of n x n places that are off a square lattice of 4 mm, bent as z = x^2 / 40.
Surface bent_sheet(Index n) {
    Surface sheet;
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            const double x = 4.0 * i + 0.8 * std::sin(7.0 * i + 3.0 * j),
                         y = 4.0 * j + 0.8 * std::cos(5.0 * i - 2.0 * j);
            sheet.vertices.emplace_back(x, y, x * x / 40);
        }
    for (Index j = 0; j + 1 < n; ++j)
        for (Index i = 0; i + 1 < n; ++i) {
            const Index p = j * n + i;
            sheet.triangles.push_back({p, p + 1, p + n});
            sheet.triangles.push_back({p + 1, p + n + 1, p + n});
        }
    return sheet;
}

bool is_on_rim(Index v, Index n) {
    return v % n == 0 || v % n == n - 1 || v / n == 0 || v / n == n - 1;
}

TEST(SurfacePatch, WhatIsLinearAlongTheSurfaceHasTheVertexsValueForItsMean) {
    constexpr Index n = 8;
    const Surface sheet = bent_sheet(n);
    const auto normals = vertex_normals(sheet);

    const auto patches = surface_patches(sheet, normals);

    ASSERT_EQ(patches.size(), sheet.vertices.size());
    int with_edges = 0;
    for (Index v = 0; v < n * n; ++v) {
        const SurfacePatch& patch = patches[v];
        ASSERT_EQ(patch.offsets.size(), patch.weights.size());
        Vec3 mean = Vec3::Zero();
        double sum = 0;
        for (std::size_t p = 0; p < patch.offsets.size(); ++p) {
            EXPECT_GT(patch.weights[p], 0);
            sum += patch.weights[p];
            mean += patch.weights[p] * patch.offsets[p];
        }
        EXPECT_NEAR(sum, 1, 1e-12);
        EXPECT_LT((mean - normals[v] * normals[v].dot(mean)).norm(), 1e-12) << v;
        EXPECT_EQ(patch.offsets[0], Vec3::Zero().eval());
        with_edges += patch.offsets.size() > 1;
        if (!is_on_rim(v, n)) {
            EXPECT_EQ(patch.offsets.size(), 7u) << v;
        }
    }
    EXPECT_GE(with_edges, (n - 2) * (n - 2));
}

TEST(SurfacePatch, OfACornerOfASheetIsTheVertexAlone) {
    const Surface sheet = bent_sheet(4);

    const SurfacePatch patch = surface_patches(sheet, vertex_normals(sheet)).front();

    EXPECT_EQ(patch.weights, std::vector{1.0});
    EXPECT_EQ(patch.num_places(), 1);
}

TEST(SurfacePatch, AMiddleOfAnEdgeBelongsToBothItsEnds) {
    const Surface sheet = bent_sheet(8);

    EXPECT_EQ(surface_patches(sheet, vertex_normals(sheet))[3 * 8 + 3].num_places(), 4);
}

}  // namespace
}  // namespace palpate

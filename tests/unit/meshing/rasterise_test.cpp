// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/rasterise.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include <gtest/gtest.h>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// A box of n x n x n cubes of edge h from `corner`, six tets each; cubes for which `keep` is false
/// are left out.
template <typename Keep>
Mesh make_block(Index n, double h, const Vec3& corner, const Keep& keep) {
    Mesh mesh;
    const Index m = n + 1;
    for (Index k = 0; k < m; ++k)
        for (Index j = 0; j < m; ++j)
            for (Index i = 0; i < m; ++i) mesh.nodes.push_back(corner + h * Vec3(i, j, k));
    const int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    const Index step[3] = {1, m, m * m};
    for (Index k = 0; k < n; ++k)
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i < n; ++i) {
                if (!keep(i, j, k)) continue;
                for (const auto& path : paths) {
                    Tet tet;
                    tet[0] = i + m * (j + m * k);
                    for (int s = 0; s < 3; ++s) tet[s + 1] = tet[s] + step[path[s]];
                    mesh.tets.push_back(tet);
                    if (tet_volume(mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]],
                                   mesh.nodes[tet[3]]) < 0) {
                        std::swap(mesh.tets.back()[2], mesh.tets.back()[3]);
                    }
                    mesh.region.push_back(1);
                }
            }
    return mesh;
}

Mesh make_full_block(Index n, double h, const Vec3& corner) {
    return make_block(n, h, corner, [](Index, Index, Index) { return true; });
}

/// Oblique and left-handed, so that no axis can be mixed up unnoticed.
ImageGrid oblique_grid() {
    ImageGrid grid;
    grid.size = {14, 11, 9};
    grid.origin = Vec3(-6, -7, -4);
    grid.spacing = Vec3(0.9, 1.1, 1.7);
    grid.direction = (Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix() *
                      Vec3(1, 1, -1).asDiagonal());
    grid.origin -= grid.direction * Vec3(0, 0, 12);
    return grid;
}

bool tet_holds(const Mesh& mesh, Index tet, const Vec3& x, double tolerance) {
    const Tet& t = mesh.tets[tet];
    const double volume = tet_volume(mesh, tet);
    for (int c = 0; c < 4; ++c) {
        std::array<Vec3, 4> p{mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]],
                              mesh.nodes[t[3]]};
        p[c] = x;
        if (tet_volume(p[0], p[1], p[2], p[3]) < -tolerance * volume) return false;
    }
    return true;
}

TEST(Rasterise, FindsTheLowestTetThatHoldsEachVoxelOfAnObliqueGrid) {
    const Mesh mesh = make_full_block(3, 3.1, Vec3(-5, -4, -3));
    const ImageGrid grid = oblique_grid();

    const std::vector<Index> tet_of = tet_of_voxels(mesh, mesh.nodes, grid);

    Index num_inside = 0;
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i) {
                const Vec3 x = grid.to_point(Vec3(i, j, k));
                Index expected = -1;
                for (Index t = 0; t < mesh.num_tets() && expected < 0; ++t) {
                    if (tet_holds(mesh, t, x, 1e-9)) expected = t;
                }
                ASSERT_EQ(tet_of[grid.offset(i, j, k)], expected) << i << ' ' << j << ' ' << k;
                num_inside += expected >= 0;
            }
    EXPECT_GT(num_inside, 100);
    EXPECT_LT(num_inside, Index(grid.num_voxels()));
}

TEST(Rasterise, CoversEveryVoxelWhoseCentreLiesOnFacesEdgesAndNodes) {
    const Mesh mesh = make_full_block(4, 2.0, Vec3::Zero());
    ImageGrid grid;
    grid.size = {9, 9, 9};  // every centre lies on a node, an edge or a face

    const std::vector<Index> tet_of = tet_of_voxels(mesh, mesh.nodes, grid);

    for (const Index tet : tet_of) ASSERT_GE(tet, 0);
}

TEST(Rasterise, FollowsDeformedNodes) {
    const Mesh mesh = make_full_block(2, 2.0, Vec3::Zero());
    std::vector<Vec3> moved = mesh.nodes;
    for (Vec3& x : moved) x += Vec3(5, 0, 0);
    ImageGrid grid;
    grid.size = {10, 4, 4};
    grid.origin = Vec3(0.5, 0.5, 0.5);

    const std::vector<Index> tet_of = tet_of_voxels(mesh, moved, grid);

    for (Index i = 0; i < 10; ++i) EXPECT_EQ(tet_of[grid.offset(i, 2, 1)] >= 0, i >= 5 && i < 9);
}

TEST(Rasterise, RefusesAListOfTheWrongLength) {
    const Mesh mesh = make_full_block(1, 1.0, Vec3::Zero());
    ImageGrid grid;
    grid.size = {2, 2, 2};

    EXPECT_THROW(tet_of_voxels(mesh, std::vector<Vec3>(3), grid), Error);
    EXPECT_THROW(displacement_on_grid(mesh, std::vector<Vec3>(9), grid), Error);
}

TEST(DisplacementOnGrid, IsExactForALinearFieldInsideTheMesh) {
    const Mesh mesh = make_full_block(3, 3.1, Vec3(-5, -4, -3));
    const ImageGrid grid = oblique_grid();
    Mat3 A;
    A << 0.1, -0.02, 0.03, 0.05, -0.1, 0.2, -0.04, 0.01, 0.07;
    std::vector<Vec3> u;
    for (const Vec3& x : mesh.nodes) u.push_back(A * x + Vec3(1, 2, 3));

    const Image<Vec3> field = displacement_on_grid(mesh, u, grid);

    const std::vector<Index> tet_of = tet_of_voxels(mesh, mesh.nodes, grid);
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i) {
                if (tet_of[grid.offset(i, j, k)] < 0) continue;
                const Vec3 expected = A * grid.to_point(Vec3(i, j, k)) + Vec3(1, 2, 3);
                ASSERT_LT((field.at(i, j, k) - expected).norm(), 1e-12);
            }
}

// The continuation stops when a multigrid cycle changes less than 5e-4.
constexpr double continuation_tolerance = 0.01;

TEST(DisplacementOnGrid, ContinuesALinearFieldLinearlyThroughAHole) {
    const auto is_wall = [](Index i, Index j, Index k) {
        return i < 2 || j < 2 || k < 2 || i > 17 || j > 15 || k > 16 || (i < 9 && j < 8);
    };
    const Mesh mesh = make_block(20, 2.0, Vec3::Zero(), is_wall);
    ImageGrid grid;
    grid.size = {40, 40, 14};
    grid.origin = Vec3(0.5, 0.5, 1.5);
    grid.spacing = Vec3(1, 1, 2.9);
    const Vec3 slope(0.2, -0.1, 0.15);
    std::vector<Vec3> u;
    for (const Vec3& x : mesh.nodes) u.push_back(slope.dot(x) * Vec3(1, 2, -1));

    const Image<Vec3> field = displacement_on_grid(mesh, u, grid);

    double largest = 0;
    for (Index k = 0; k < 13; ++k)
        for (Index j = 0; j < 40; ++j)
            for (Index i = 0; i < 40; ++i) {
                const Vec3 x = grid.to_point(Vec3(i, j, k));
                largest =
                    std::max(largest, (field.at(i, j, k) - slope.dot(x) * Vec3(1, 2, -1)).norm());
            }
    EXPECT_LT(largest, continuation_tolerance);
}

TEST(DisplacementOnGrid, StaysConstantBeyondASlabInABoxOfInsulatedWalls) {
    // Between two slabs of value 1 and 3 the solution is linear; beyond them it is constant.
    Mesh mesh =
        make_block(30, 1.0, Vec3::Zero(), [](Index i, Index, Index) { return i == 8 || i == 20; });
    ImageGrid grid;
    grid.size = {30, 30, 30};
    grid.origin = Vec3(0.5, 0.5, 0.5);
    std::vector<Vec3> u;
    for (const Vec3& x : mesh.nodes) u.push_back(Vec3(x[0] < 15 ? 1 : 3, 0, 0));

    const Image<Vec3> field = displacement_on_grid(mesh, u, grid);

    EXPECT_NEAR(field.at(0, 3, 29)[0], 1.0, continuation_tolerance);
    EXPECT_NEAR(field.at(14, 15, 10)[0], 2.0, continuation_tolerance);
    EXPECT_NEAR(field.at(11, 0, 0)[0], 1.5, continuation_tolerance);
    EXPECT_NEAR(field.at(29, 29, 0)[0], 3.0, continuation_tolerance);
}

/// An L of labels 1, 2, 3 that no flip or axis swap maps onto itself.

}  // namespace
}  // namespace palpate

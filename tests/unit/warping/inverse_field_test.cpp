// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/inverse_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "host/geometry/meshing/rasterise.hpp"
#include "host/geometry/warping/displacement_field.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/unit/warping/oblique_scene.hpp"

namespace palpate {
namespace {

using namespace testing;

const RigidTransform motion{Eigen::AngleAxisd(0.15, Vec3(3, -1, 2).normalized()).toRotationMatrix(),
                            Vec3(7, -4, 11)};

/// A body that fills most of the grid and is not aligned with it.
Mesh body_in(const ImageGrid& grid) {
    Mesh mesh = fixtures::box_mesh({12, 10, 8}, Vec3(30, 30, 34));
    const Vec3 centre =
        grid.to_point(Vec3(grid.size[0] - 1.0, grid.size[1] - 1.0, grid.size[2] - 1.0) / 2);
    const Mat3 turn = Eigen::AngleAxisd(-0.2, Vec3(1, 1, 0).normalized()).toRotationMatrix();
    for (Vec3& x : mesh.nodes) x = centre + turn * (x - Vec3(15, 15, 17));
    return mesh;
}

struct Errors {
    double mean = 0, largest = 0;
};

/// |back(there(x)) - x|, mm, for points whose image lies well inside the other grid.
Errors consistency(const PointMap& there, const PointMap& back, const std::vector<Vec3>& points) {
    Errors errors;
    double count = 0;
    for (const Vec3& x : points) {
        const MovedPoint y = there.moved(x);
        const MovedPoint again = back.moved(y.point);
        if (!y.inside || !again.inside) continue;
        const double error = (again.point - x).norm();
        errors.mean += error;
        errors.largest = std::max(errors.largest, error);
        ++count;
    }
    EXPECT_GT(count, 0.6 * points.size());
    errors.mean /= count;
    return errors;
}

TEST(InverseField, IsExactAtVoxelCentresInsideTheMovedMesh) {
    const ImageGrid grid = oblique_grid();
    const Mesh mesh = body_in(grid);
    std::vector<Vec3> u, moved;
    for (const Vec3& x : mesh.nodes) {
        u.push_back(smooth_displacement(x));
        moved.push_back(motion.apply(x + u.back()));
    }
    ImageGrid target = grid;
    target.origin = motion.apply(grid.origin);
    const Image<Vec3> field = displacement_on_grid(mesh, u, grid);

    const Image<Vec3> inverse = inverse_field(mesh, u, field, motion, target).field;

    // Back through the same tetrahedron, by its corners.
    const auto tet_of = tet_of_voxels(mesh, moved, target);
    std::size_t inside = 0;
    for (std::size_t v = 0; v < tet_of.size(); ++v) {
        if (tet_of[v] < 0) continue;
        ++inside;
        const Index n = static_cast<Index>(v);
        const Vec3 y = target.to_point(Vec3(n % target.size[0], n / target.size[0] % target.size[1],
                                            n / (target.size[0] * target.size[1])));
        const Vec3 x = y + inverse.voxels[v];
        const Tet& tet = mesh.tets[tet_of[v]];
        Mat3 edges, moved_edges;
        for (int c = 0; c < 3; ++c) {
            edges.col(c) = mesh.nodes[tet[c + 1]] - mesh.nodes[tet[0]];
            moved_edges.col(c) = moved[tet[c + 1]] - moved[tet[0]];
        }
        const Vec3 weights = edges.inverse() * (x - mesh.nodes[tet[0]]);
        ASSERT_LT((moved[tet[0]] + moved_edges * weights - y).norm(), 1e-9);
    }
    EXPECT_GT(inside, 3000u);
}

TEST(InverseField, UndoesTheForwardFieldWithinASmallPartOfAVoxel) {
    // Voxels of 1.3 x 1.7 x 2.9 mm, displacements of 6 mm, strains of 0.3, elements of 3 to 4 mm.
    // Measured: 0.012 and 0.32 mm, the largest at the body's surface, where the field has a kink.
    constexpr double mean_mm = 0.02, largest_mm = 0.4;
    const ImageGrid grid = oblique_grid();
    const Mesh mesh = body_in(grid);
    std::vector<Vec3> u;
    for (const Vec3& x : mesh.nodes) u.push_back(smooth_displacement(x));
    const Image<Vec3> field = displacement_on_grid(mesh, u, grid);
    Image<Vec3> total = field;  // as it is written: with the rigid motion
    for (std::size_t v = 0; v < total.voxels.size(); ++v) {
        const Index n = static_cast<Index>(v);
        const Vec3 x = grid.to_point(Vec3(n % grid.size[0], n / grid.size[0] % grid.size[1],
                                          n / (grid.size[0] * grid.size[1])));
        total.voxels[v] = motion.apply(x + field.voxels[v]) - x;
    }
    ImageGrid target = grid;
    target.origin = motion.apply(grid.origin);
    target.direction = motion.rotation * grid.direction;

    const PointMap there{total}, back{inverse_field(mesh, u, field, motion, target).field};
    const Errors forth = consistency(there, back, points_in(grid, 4000, 0.0));
    const Errors home = consistency(back, there, points_in(target, 4000, 0.0));

    RecordProperty("mean_mm", std::to_string(forth.mean));
    RecordProperty("largest_mm", std::to_string(forth.largest));
    std::printf("inverse consistency: mean %.4f mm, largest %.4f mm; from the target %.4f, %.4f\n",
                forth.mean, forth.largest, home.mean, home.largest);
    EXPECT_LT(forth.mean, mean_mm);
    EXPECT_LT(forth.largest, largest_mm);
    EXPECT_LT(home.mean, mean_mm);
    EXPECT_LT(home.largest, largest_mm);
}

TEST(InverseField, OfAFieldAloneUndoesItAtTheVoxelCentres) {
    constexpr double tolerance_mm = 2e-3;
    const Image<Vec3> field = sampled(oblique_grid(), smooth_displacement);

    const Image<Vec3> inverse = inverse_field(field, field.grid).field;

    for (Index k = 3; k < 14; ++k)
        for (Index j = 5; j < 24; ++j)
            for (Index i = 6; i < 28; ++i) {
                const Vec3 y = field.grid.to_point(Vec3(i, j, k)), x = y + inverse.at(i, j, k);
                ASSERT_LT((x + displacement_at(field, x) - y).norm(), tolerance_mm);
            }
}

TEST(InverseField, CountsTheVoxelsThatNothingIsMovedTo) {
    Image<Vec3> field = sampled(oblique_grid(), [](const Vec3&) { return Vec3(0, 0, 0); });
    EXPECT_EQ(inverse_field(field, field.grid).num_unsure, 0u);

    // All points of a row come from one: none of the others' places is reached.
    for (Index i = 0; i < field.grid.size[0]; ++i)
        field.at(i, 8, 8) = field.grid.to_point(Vec3(0, 8, 8)) - field.grid.to_point(Vec3(i, 8, 8));
    EXPECT_GT(inverse_field(field, field.grid).num_unsure, 0u);
}

}  // namespace
}  // namespace palpate

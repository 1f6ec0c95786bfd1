// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/nearest_triangles.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "host/geometry/surfaces/closest_point.hpp"
#include "tests/unit/imaging/voxelised.hpp"
#include "tests/unit/surfaces/analytic_surfaces.hpp"

namespace palpate {
namespace {

using namespace testing;

TEST(NearestTriangles, AgreesWithTheExactSearch) {
    // An ellipsoid, so that the nearest triangle is not ambiguous at the centre.
    Surface surface = sphere_surface(Vec3::Zero(), 1, 40);
    for (Vec3& v : surface.vertices) v = v.cwiseProduct(Vec3(12, 9, 7)) + Vec3(1, 2, 3);
    const ImageGrid grid = grid_around(Vec3(1, 2, 3), 40, Vec3::Ones(), left_handed_direction());
    const ClosestPointQuery query(surface);

    const NearestTriangles nearest = nearest_triangles(surface, grid, 4.0);

    std::vector<double> errors, near_errors;
    for (Index k = 0; k < grid.size[2]; ++k) {
        for (Index j = 0; j < grid.size[1]; ++j) {
            for (Index i = 0; i < grid.size[0]; ++i) {
                const double exact = query.closest(grid.to_point(Vec3(i, j, k))).distance_mm;
                const double error = nearest.distance[grid.offset(i, j, k)] - exact;
                ASSERT_GT(error, -1e-4);
                if (exact < 2) {
                    ASSERT_LT(error, 1e-4);
                }
                if (exact < 3) near_errors.push_back(error);
                errors.push_back(error);
            }
        }
    }
    const ErrorSummary far = summary_of(errors);
    const ErrorSummary near = summary_of(near_errors);
    std::printf("    within 3 mm mean %.5f max %.5f mm\n", near.mean, near.max);
    EXPECT_LT(near.max, 0.1);
    std::printf("    missed by mean %.4f max %.4f mm\n", far.mean, far.max);
    EXPECT_LT(far.mean, 0.02);
    EXPECT_LT(far.max, 0.3);  // on the medial surface
}

}  // namespace
}  // namespace palpate

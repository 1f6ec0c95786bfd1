// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/demons.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

/// A ball of label 1 in a grid of 48 x 40 x 22 voxels of 1 x 1 x 2 mm that does not begin at zero.
LabelImage ball_at(const Vec3& centre, double radius_mm) {
    ImageGrid grid;
    grid.size = {48, 40, 22};
    grid.spacing = Vec3(1, 1, 2);
    grid.origin = Vec3(-24, 10, 100);
    LabelImage image{grid, std::vector<std::uint16_t>(grid.num_voxels(), 0)};
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i)
                image.at(i, j, k) = (grid.to_point(Vec3(i, j, k)) - centre).norm() < radius_mm;
    return image;
}

TEST(Demons, TakeAReferenceToItsTargetAndNotBack) {
    const Vec3 centre(0, 30, 120), shift(3, -1, 2);

    const Image<Vec3> field = demons_displacement(ball_at(centre, 11), ball_at(centre + shift, 11));

    // Motion along the surface shows nowhere, so only the part along the normal is judged.
    double error = 0, moved = 0;
    int count = 0;
    for (Index k = 0; k < field.grid.size[2]; ++k)
        for (Index j = 0; j < field.grid.size[1]; ++j)
            for (Index i = 0; i < field.grid.size[0]; ++i) {
                const Vec3 from_centre = field.grid.to_point(Vec3(i, j, k)) - centre;
                if (std::abs(from_centre.norm() - 11) > 0.7) continue;
                const Vec3 normal = from_centre.normalized();
                error += std::abs((field.at(i, j, k) - shift).dot(normal));
                moved += std::abs(shift.dot(normal));
                ++count;
            }
    ASSERT_GT(count, 100);
    EXPECT_LT(error / count, 0.4);
    EXPECT_GT(moved / count, 1.5);
}

TEST(Demons, LeaveWhatDoesNotMove) {
    const LabelImage ball = ball_at(Vec3(0, 30, 120), 11);

    for (const Vec3& u : demons_displacement(ball, ball).voxels) ASSERT_LT(u.norm(), 1e-3);
}

}  // namespace
}  // namespace palpate

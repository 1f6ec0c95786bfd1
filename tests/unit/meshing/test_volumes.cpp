// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/meshing/test_volumes.hpp"

#include <cmath>

namespace palpate::testing {

RegionImage ball_image(double size_mm, double voxel_mm, const std::vector<Ball>& balls,
                       const Mat3& direction) {
    RegionImage image;
    const Index n = static_cast<Index>(std::lround(size_mm / voxel_mm));
    image.grid.size = {n, n, n};
    image.grid.spacing = Vec3::Constant(voxel_mm);
    image.grid.direction = direction;
    image.grid.origin = direction * Vec3::Constant(voxel_mm / 2);
    image.voxels.assign(image.grid.num_voxels(), background_region);
    for (Index k = 0; k < n; ++k)
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i < n; ++i)
                for (const Ball& ball : balls) {
                    const Vec3 p = voxel_mm * (Vec3(i, j, k) + Vec3::Constant(0.5));
                    if ((p - ball.centre).norm() < ball.radius)
                        image.at(i, j, k) = static_cast<std::uint8_t>(ball.region);
                }
    return image;
}

std::vector<Ball> pelvis_balls() {
    return {
        {{60, 55, 45}, 18, 2}, {{60, 55, 45}, 8, 5}, {{60, 50, 88}, 23, 3}, {{60, 92, 50}, 16, 4}};
}

RegionImage plain_image() { return ball_image(40, 4, {}); }

}  // namespace palpate::testing

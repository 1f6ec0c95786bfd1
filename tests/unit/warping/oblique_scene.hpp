// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "host/io/image.hpp"

namespace palpate::testing {

/// Oblique, anisotropic, left-handed, far from the origin: no axis or sign can be mixed up unseen.
inline ImageGrid oblique_grid(std::array<Index, 3> size = {34, 29, 17}) {
    ImageGrid grid;
    grid.size = size;
    grid.origin = Vec3(31, -57, 113);
    grid.spacing = Vec3(1.3, 1.7, 2.9);
    grid.direction = Eigen::AngleAxisd(0.4, Vec3(1, 2, -3).normalized()).toRotationMatrix() *
                     Vec3(1, -1, 1).asDiagonal();
    return grid;
}

/// A smooth displacement of up to 6 mm with strains of up to 0.3, different along each axis.
inline Vec3 smooth_displacement(const Vec3& x) {
    const Vec3 q = x - Vec3(45, -75, 135);
    return {4.0 * std::sin(0.06 * q.x() + 0.03 * q.z()) + 1.5,
            -3.0 * std::cos(0.05 * q.y() - 0.04 * q.x()),
            2.0 * std::sin(0.07 * q.z()) * std::cos(0.05 * q.y()) - 2.5};
}

template <typename Function>
Image<Vec3> sampled(const ImageGrid& grid, const Function& displacement) {
    Image<Vec3> field{grid, {}};
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i)
                field.voxels.push_back(displacement(grid.to_point(Vec3(i, j, k))));
    return field;
}

/// Points spread over the inner part of a grid: `margin` (0..0.5) of each axis is left out at both
/// ends. The same at every call.
inline std::vector<Vec3> points_in(const ImageGrid& grid, std::size_t count, double margin) {
    std::vector<Vec3> points;
    double a = 0.11, b = 0.47, c = 0.83;
    for (std::size_t n = 0; n < count; ++n) {
        a = std::fmod(a + 0.618033988, 1.0);  // three sequences of low discrepancy
        b = std::fmod(b + 0.754877666, 1.0);
        c = std::fmod(c + 0.569840291, 1.0);
        const Vec3 unit = Vec3::Constant(margin) + (1 - 2 * margin) * Vec3(a, b, c);
        points.push_back(grid.to_point(
            unit.cwiseProduct(Vec3(grid.size[0] - 1.0, grid.size[1] - 1.0, grid.size[2] - 1.0))));
    }
    return points;
}

}  // namespace palpate::testing

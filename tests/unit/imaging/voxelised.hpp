// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>

#include "host/io/label_image.hpp"

namespace palpate::testing {

/// A grid whose box is centred on `centre` and at least `extent_mm` long along each of its axes.
inline ImageGrid grid_around(const Vec3& centre, double extent_mm, const Vec3& spacing,
                             const Mat3& direction = Mat3::Identity()) {
    ImageGrid grid;
    grid.spacing = spacing;
    grid.direction = direction;
    Vec3 half;
    for (int a = 0; a < 3; ++a) {
        grid.size[a] = static_cast<Index>(std::ceil(extent_mm / spacing[a]));
        half[a] = 0.5 * (grid.size[a] - 1) * spacing[a];
    }
    grid.origin = centre - direction * half;
    return grid;
}

/// Fills each voxel with the region of its centre.
inline RegionImage voxelised(const ImageGrid& grid,
                             const std::function<Index(const Vec3&)>& region) {
    RegionImage image{grid, std::vector<std::uint8_t>(grid.num_voxels())};
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i)
                image.at(i, j, k) = static_cast<std::uint8_t>(region(grid.to_point(Vec3(i, j, k))));
    return image;
}

/// Region 2 inside the sphere, background outside.
inline RegionImage voxelised_sphere(const ImageGrid& grid, const Vec3& centre, double radius) {
    return voxelised(grid, [&](const Vec3& x) {
        return (x - centre).norm() < radius ? first_organ_region : background_region;
    });
}

inline Mat3 oblique_direction() {
    return (Eigen::AngleAxisd(0.4, Vec3(1, 2, -1).normalized()) *
            Eigen::AngleAxisd(-0.7, Vec3::UnitZ()))
        .toRotationMatrix();
}

inline Mat3 left_handed_direction() {
    Mat3 direction = oblique_direction();
    direction.col(1) *= -1;
    return direction;
}

/// Evenly spread unit vectors (Fibonacci lattice).
inline std::vector<Vec3> unit_vectors(int count) {
    std::vector<Vec3> result;
    for (int n = 0; n < count; ++n) {
        const double z = 1 - (2 * n + 1.0) / count, angle = n * 2.399963229728653;
        const double radius = std::sqrt(1 - z * z);
        result.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return result;
}

/// Mean, root mean square and largest magnitude of a list of errors.
struct ErrorSummary {
    double mean = 0, rms = 0, max = 0;
};
inline ErrorSummary summary_of(const std::vector<double>& errors) {
    ErrorSummary s;
    for (double e : errors) {
        s.mean += e / double(errors.size());
        s.rms += e * e / double(errors.size());
        s.max = std::max(s.max, std::abs(e));
    }
    s.rms = std::sqrt(s.rms);
    return s;
}

}  // namespace palpate::testing

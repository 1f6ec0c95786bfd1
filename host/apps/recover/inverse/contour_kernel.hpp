// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "host/apps/recover/observations/voxel_terraces.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// Length (mm) of the correlation of what whoever drew a contour adds.
constexpr double contour_length_mm = 7.0;

/// Matern 3/2: (1 + q) exp(-q), q = sqrt(3) d / l. Rough, because a smooth one would claim that no
/// error is left at short lengths and make much of tenths of a millimetre there.
inline double contour_correlation(double distance_mm) {
    const double q = std::numbers::sqrt3 * distance_mm / contour_length_mm;
    return (1.0 + q) * std::exp(-q);
}

/// Where a point of a surface lies among the slices of one image.
struct SlicePlace {
    double height_mm = 0;         ///< along the slices' normal
    Vec3 inplane = Vec3::Zero();  ///< the part of the surface's unit normal that lies in the slice
    double range_mm = 0;  ///< the correlation between slices falls to 1/e; 0: there are none
};
using SlicePlaces = std::array<SlicePlace, 2>;  ///< of the reference's image and the target's

/// Slices lie across the axis of the largest spacing, of equal ones across the last. Smoothing
/// spreads what one slice is off by over its neighbours.
SlicePlace slice_place(const VoxelPlanes& voxels, const Vec3& place, const Vec3& normal);

/// Correlation of contours that somebody drew slice by slice, each shifted and waved in its plane
/// by itself: with heights z, in-plane normals n, distances d in the plane
///   exp(-|z_a - z_b| / range) (|n_a| |n_b| k(d) + n_a . n_b) / 2,   k = contour_correlation,
/// the mean of both images. One where a = b and the surface is upright; zero on caps.
double slice_correlation(const SlicePlaces& a, const SlicePlaces& b, double distance_mm);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Signed distance (mm, negative inside) from every voxel centre to the surface of the union of the
/// marked voxels, taken as boxes. Exact, and the same for a mask and its complement up to the sign,
/// so that a plane or a sphere is not shifted (distances between voxel centres are: by half a
/// voxel).
///   mask     [size[0] * size[1] * size[2]], 1 inside, index 0 fastest
///   spacing  mm per axis
/// A mask that is empty or full gives +-`distance_to_nothing_mm`.
/// Cost: six passes of a lower envelope of parabolas (Felzenszwalb and Huttenlocher, Theory of
/// Computing 8, 2012), linear in the number of voxels.
std::vector<float> signed_distance(const std::array<Index, 3>& size, const Vec3& spacing,
                                   const std::vector<std::uint8_t>& mask);

constexpr float distance_to_nothing_mm = 1e4f;

/// Smooths a volume in place by a kernel of standard deviation `sigma_mm` whose second moment is
/// removed: k = 2 g - g * g with the Gaussian g, per axis. A plain Gaussian moves a surface of mean
/// curvature 1/r inward by sigma^2 / r; this one does not, to the next order. Ends are mirrored.
void smooth_without_shrinking(const std::array<Index, 3>& size, const Vec3& spacing,
                              double sigma_mm, std::vector<float>& volume);

}  // namespace palpate

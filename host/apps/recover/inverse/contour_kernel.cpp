// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/contour_kernel.hpp"

#include <algorithm>

namespace palpate {

SlicePlace slice_place(const VoxelPlanes& voxels, const Vec3& place, const Vec3& normal) {
    int across = 2;
    for (int axis = 0; axis < 2; ++axis)
        if (voxels.spacing[axis] > 1.01 * voxels.spacing[across]) across = axis;
    const Vec3 direction = voxels.axes.col(across);
    const Vec3 unit = normal.normalized();
    return {direction.dot(place), unit - unit.dot(direction) * direction,
            voxels.smoothing_mm + 0.5 * voxels.spacing[across]};
}

double slice_correlation(const SlicePlaces& a, const SlicePlaces& b, double distance_mm) {
    double sum = 0;
    int images = 0;
    for (std::size_t v = 0; v < a.size(); ++v) {
        const SlicePlace &at = a[v], &other = b[v];
        if (at.range_mm == 0) continue;
        ++images;
        const double apart = std::abs(at.height_mm - other.height_mm);
        const double inplane = std::sqrt(std::max(0.0, distance_mm * distance_mm - apart * apart));
        sum += 0.5 * std::exp(-apart / at.range_mm) *
               (at.inplane.norm() * other.inplane.norm() * contour_correlation(inplane) +
                at.inplane.dot(other.inplane));
    }
    return images > 0 ? sum / images : 0.0;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/geometry/warping/displacement_field.hpp"

namespace palpate {

/// Straight lines along the axes of an image, after they were moved: a picture of a deformation.
struct MovedGrid {
    std::vector<MovedPoint> points;         ///< LPS mm
    std::vector<Vec3> displacement;         ///< [points] mm
    std::vector<std::vector<Index>> lines;  ///< point numbers in order
};

/// Lines `every_mm` apart, through voxel centres of `grid`, with a point at each voxel.
/// Throws Error(invalid_argument) if `every_mm` is not positive.
MovedGrid moved_grid(const PointMap& map, const ImageGrid& grid, double every_mm);

/// Writes .vtp with point arrays `displacement` (mm) and `inside`, field data SPACE = LPS.
/// Throws Error(output_failed), Error(unsupported) for another ending.
void write_moved_grid(const std::filesystem::path& path, const MovedGrid& grid);

}  // namespace palpate

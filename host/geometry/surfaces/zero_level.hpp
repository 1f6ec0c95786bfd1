// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "host/geometry/surfaces/surface.hpp"
#include "host/io/image.hpp"

namespace palpate {

/// Triangles of the surface where a function is zero, one layer of marching tetrahedra (six per
/// cell): without holes, but open where it leaves the grid. Normals point towards positive values.
///   samples   values of the function at the grid points, [num_voxels]; 0 counts as positive
///   function  the function itself: vertices are moved along their edge onto its zero
/// Cost: one pass over the grid and about three calls of `function` per vertex.
Surface zero_level(const ImageGrid& grid, const std::vector<float>& samples,
                   const std::function<double(const Vec3&)>& function);

}  // namespace palpate

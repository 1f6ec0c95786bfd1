// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/surfaces/surface.hpp"
#include "host/io/image.hpp"

namespace palpate {

struct NearestTriangles {
    std::vector<float> distance;  ///< [num_voxels] mm
    std::vector<Index> triangle;  ///< [num_voxels]
};

/// The triangle nearest to every point of a grid: exact within two samples of the surface. Farther
/// out each point tries what its neighbours found, in eight sweeps (Zhao, Mathematics of
/// Computation 74, 2005), which can miss the nearest one for its neighbour on the surface: the
/// triangles of its neighbours up to `reach_mm`, beyond that only their nearest points (Danielsson
/// 1980), which are about a sample apart and so too long by h^2 / (8 reach_mm) at most.
/// `surface` must have a triangle within the grid, and triangles about as small as the spacing.
NearestTriangles nearest_triangles(const Surface& surface, const ImageGrid& grid, double reach_mm);

}  // namespace palpate

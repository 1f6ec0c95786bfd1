// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/imaging/image.hpp"
#include "host/surfaces/surface.hpp"

namespace palpate {

struct NearestTriangles {
    std::vector<float> distance;  ///< [num_voxels] mm
    std::vector<Index> triangle;  ///< [num_voxels]
};

/// The triangle nearest to every point of a grid: exact within two samples of the surface; farther
/// out each point tries the triangles of its neighbours in eight sweeps (Zhao, Mathematics of
/// Computation 74, 2005), which can miss the nearest one for its neighbour on the surface.
/// `surface` must have a triangle within the grid, and triangles about as small as the spacing.
NearestTriangles nearest_triangles(const Surface& surface, const ImageGrid& grid);

}  // namespace palpate

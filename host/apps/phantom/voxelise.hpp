// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/meshing/mesher.hpp"
#include "host/io/label_image.hpp"

namespace palpate {

/// The region of every voxel centre of `grid` for mesh nodes at `nodes` (mm, LPS; deformed or not):
/// that of the tet which holds it; where there is none, the hollow region whose surface is nearest
/// (a point in a cavity is nearest to its own wall). Centres beyond the box are background.
RegionImage regions_on_grid(const RegionMesh& mesh, const std::vector<Vec3>& nodes,
                            const std::vector<Index>& hollow, const ImageGrid& grid);

}  // namespace palpate

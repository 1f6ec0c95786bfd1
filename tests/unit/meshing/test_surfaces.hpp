// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/geometry/surfaces/surface.hpp"

namespace palpate::testing {

/// Adds a sphere of 20 * 4^level triangles, region `inside` in region `around`.
void add_sphere(RegionSurface& surface, const Vec3& centre, double radius, int level, Index inside,
                Index around);

/// Adds an axis-aligned box of `cells` squares per side, two triangles each, on the image border if
/// `around` is outside.
void add_box(RegionSurface& surface, const Vec3& low, const Vec3& high, std::array<int, 3> cells,
             Index inside, Index around);

/// Boxes of unit cells in a row along x that share their walls: region numbers from left to right,
/// `cells` squares per side of each.
RegionSurface touching_boxes(const std::vector<Index>& regions, int cells, double side_mm);

/// A pelvis in spheres: box 120 mm (background 1), prostate 2 with a zone 5 nested in it, hollow
/// bladder 3 and rectum 4.
RegionSurface sphere_pelvis(int level);

}  // namespace palpate::testing

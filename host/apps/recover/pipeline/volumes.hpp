// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/modelling/settings.hpp"
#include "host/geometry/fields/label_field.hpp"

namespace palpate {

/// Regions of the reference seen on the target's grid: for every target voxel centre y the region
/// of `reference` at the point x that the alignment alone carries to y.
RegionImage carry_regions(const LabelField& reference, const RigidTransform& reference_to_target,
                          const ImageGrid& target_grid);

/// The same for x = y + v(y), with the displacements v given on the target's grid.
RegionImage carry_regions(const LabelField& reference, const Image<Vec3>& target_to_reference);

/// File labels of a region image.
LabelImage to_labels(const RegionImage& regions, const Settings& settings);

/// Dice coefficient of one region in two images of one grid: 2 |A and B| / (|A| + |B|).
double dice(const RegionImage& a, const RegionImage& b, Index region);

/// The field that the user gets: x -> transform(x + u(x)) - x on the grid of `displacement`.
Image<Vec3> with_alignment(const Image<Vec3>& displacement, const RigidTransform& transform);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/phantom/organ_shape.hpp"
#include "host/io/label_image.hpp"

namespace palpate {

/// Where the prostate's transition zone ends inside it: a smaller irregular body in its front that
/// comes out at its front surface; what is left is the peripheral zone, a cup behind and beside it
/// (McNeal 1981). The seed varies size, place and interface.
OrganShape make_transition_zone(const OrganShape& prostate, unsigned seed);

/// Gives the voxels of region `whole` whose centres lie in `zone` the number `part`.
void mark_zone(RegionImage& image, const OrganShape& zone, Index whole, Index part);

}  // namespace palpate

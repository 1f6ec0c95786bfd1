// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/surfaces/interfaces.hpp"
#include "host/geometry/surfaces/surface_complex.hpp"

namespace palpate {

/// Volume enclosed by each region's faces, mm^3, [num_regions].
std::vector<double> enclosed_volumes(const SurfaceComplex& complex, Index num_regions);

/// Moves the interfaces along their normals so that each region encloses the wanted volume: region
/// a grows by its own offset, the interface to b by the difference of the two, with offsets from
/// the balance  sum_b area_ab (offset_a - offset_b) = wanted_a - enclosed_a.  The offsets are kept
/// in `interfaces`.
void match_volumes(SurfaceComplex& complex, Interfaces& interfaces,
                   const std::vector<double>& wanted, int rounds);

}  // namespace palpate

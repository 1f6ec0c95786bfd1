// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/geometry/surfaces/surface_complex.hpp"

namespace palpate {

/// Pairs of faces that cross, touch or fold over each other.
std::vector<std::array<Index, 2>> crossing_faces(const SurfaceComplex& complex);

/// Evens out the surroundings of crossing faces, wider and wider, until none crosses; the box stays
/// as it is. Returns whether that succeeded within `rounds`.
bool untangle(SurfaceComplex& complex, int rounds);

}  // namespace palpate

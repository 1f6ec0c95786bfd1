// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

/// A line of points, mm LPS; closed where its last point is its first.
using SectionLine = std::vector<Vec3>;

/// Where a surface meets the plane on which coordinate `axis` (0, 1, 2) is `at_mm`: the lines of
/// the triangles, joined end to end. Empty if they do not meet.
std::vector<SectionLine> plane_section(const Surface& surface, int axis, double at_mm);

/// The line without the points that lie nearer than `tolerance_mm` to what remains (Ramer 1972,
/// Douglas and Peucker 1973). Its ends stay.
SectionLine thinned(const SectionLine& line, double tolerance_mm);

}  // namespace palpate

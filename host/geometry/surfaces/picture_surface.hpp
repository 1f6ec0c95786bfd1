// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "host/geometry/surfaces/surface.hpp"
#include "host/geometry/surfaces/target_shape.hpp"

namespace palpate {

/// The surface that a closed shape describes, as triangles of about `edge_length_mm`, for pictures.
///   near  points that the surface lies round, mm; 10 mm beyond their box is searched
///   keep  whether the surface was seen at a point; triangles elsewhere are left out
Surface picture_surface(const TargetShape& shape, const std::vector<Vec3>& near,
                        double edge_length_mm, const std::function<bool(const Vec3&)>& keep);

/// A cloud of points as small octahedra that hardly touch, of at most 4000 points evenly taken from
/// it, for pictures. `spacing_mm`: distance between neighbours.
Surface picture_of_points(const std::vector<Vec3>& points, double spacing_mm);

}  // namespace palpate

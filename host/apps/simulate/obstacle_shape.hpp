// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "host/page/surface_view.hpp"
#include "solver/model/contact.hpp"

namespace palpate {

/// The surface of an obstacle beside a body in this box; what has no end ends a little beyond it.
/// In a plane, cylinders are drawn as spheres, whose rims are the same circles, and of tubes and
/// punches their section.
TriangleShape obstacle_shape(const Obstacle& obstacle, const Eigen::AlignedBox3d& body,
                             bool is_plane);

}  // namespace palpate

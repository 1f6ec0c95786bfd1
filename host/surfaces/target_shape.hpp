// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/types.hpp"

namespace palpate {

/// Where a surface point is from a shape that it should come to lie on.
struct ShapeDistance {
    double mm = 0;               ///< along the shape's normal, negative inside
    Vec3 normal = Vec3::Zero();  ///< gradient of `mm`
    bool is_seen = true;         ///< false: the shape says nothing about this point
};

/// What the surface of an organ is measured against: the zero level of a distance map, a triangle
/// surface, open or closed, or a cloud of points. Const calls are thread safe.
class TargetShape {
public:
    virtual ~TargetShape() = default;
    /// `facing`: about the outward normal of the surface at the point; it gives a shape without
    /// inside and outside its sign.
    virtual ShapeDistance measure(const Vec3& point, const Vec3& facing) const = 0;
};

}  // namespace palpate

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
    /// Unit normal of the shape without what is shorter than `normal_smoothing_mm`.
    Vec3 smooth_normal = Vec3::Zero();
};

/// Standard deviation of the Gaussian over which normals are smoothed. Contours are off by waves of
/// 5 to 10 mm; a wall that slides along the slopes of those would follow noise.
constexpr double normal_smoothing_mm = 3.0;

/// What the surface of an organ is measured against: the zero level of a distance map, a triangle
/// surface, open or closed, or a cloud of points. Const calls are thread safe.
class TargetShape {
public:
    virtual ~TargetShape() = default;
    /// `facing`: about the outward normal of the organ's surface at the point, of any length. A
    /// shape that was seen from some sides only says nothing about a point that faces elsewhere;
    /// zero: every point is taken to face as the shape does.
    virtual ShapeDistance measure(const Vec3& point, const Vec3& facing) const = 0;
    /// The area of the shape that one measurement stands for, mm^2; 0: as small as one likes.
    virtual double measured_area_mm2() const { return 0; }
    /// Whether it is off from place to place as voxels make it, so that a mean over places of a
    /// surface is known better than one of them.
    virtual bool is_of_voxels() const { return false; }
};

/// Whether surfaces with these outward normals can be one and the same: they are at most 60 degrees
/// apart. Zero goes with everything.
inline bool face_alike(const Vec3& a, const Vec3& b) {
    return a.dot(b) >= 0.5 * a.norm() * b.norm();
}

}  // namespace palpate

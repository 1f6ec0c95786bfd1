// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/geometry/surfaces/closest_point.hpp"
#include "host/geometry/surfaces/target_shape.hpp"

namespace palpate {

/// A triangle surface, closed or open. The distance is taken to the closest point along a normal
/// that is interpolated between the vertices, so that it has no kinks at edges. A point whose
/// closest point lies on the rim of an open surface is not seen: there the surface only ends. Nor
/// is one that faces away from its closest point: that belongs to another side of the organ.
class SurfaceShape : public TargetShape {
public:
    /// Throws Error(invalid_argument) for a surface without triangles.
    explicit SurfaceShape(Surface surface);
    ShapeDistance measure(const Vec3& point, const Vec3& facing) const override;

    /// Distance to the closest point, and whether that is on the rim of the open surface.
    struct Distance {
        double mm = 0;
        bool is_on_rim = false;
    };
    Distance distance(const Vec3& point) const;

private:
    Vec3 weights(const Vec3& point, const Triangle& corners) const;
    bool on_rim(Index triangle, const Vec3& weights) const;

    Surface surface_;
    ClosestPointQuery query_;
    std::vector<Vec3> vertex_normals_, smooth_normals_;
    std::vector<std::array<bool, 3>> is_rim_;  ///< [num_triangles] the edge opposite each corner
};

}  // namespace palpate

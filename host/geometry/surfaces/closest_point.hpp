// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

struct ClosestPoint {
    Vec3 point = Vec3::Zero();
    Index triangle = -1;
    double distance_mm = 0;
};

Vec3 closest_point_of_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Exact closest points on a triangle surface, by a bounding-volume tree. Const calls are thread
/// safe. Throws Error(invalid_argument) for a surface without triangles.
class ClosestPointQuery {
public:
    explicit ClosestPointQuery(const Surface& surface);
    ~ClosestPointQuery();
    /// `near_triangle`, e.g. the answer for a neighbouring point, only speeds up the search.
    ClosestPoint closest(const Vec3& point, Index near_triangle = -1) const;
    /// Many points at once, on all cores; fastest if neighbours in the list are neighbours in
    /// space.
    std::vector<ClosestPoint> closest(const std::vector<Vec3>& points) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

struct SurfaceDistance {
    double mean_mm = 0, rms_mm = 0, p95_mm = 0, max_mm = 0;
};

/// Distances of the vertices of `from` to the surface `to`, vertices weighted by their area. Zero
/// if `from` has no area.
SurfaceDistance surface_distance(const Surface& from, const Surface& to);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "host/surfaces/surface.hpp"

namespace palpate {

struct ClosestPoint {
    Vec3 point = Vec3::Zero();
    Index triangle = -1;
    double distance_mm = 0;
};

/// Exact closest points on a triangle surface, by a bounding-volume tree. Const calls are thread safe.
class ClosestPointQuery {
public:
    explicit ClosestPointQuery(const Surface& surface);
    ~ClosestPointQuery();
    ClosestPoint closest(const Vec3& point) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

struct SurfaceDistance {
    double mean_mm = 0, rms_mm = 0, p95_mm = 0, max_mm = 0;
};

/// Distances of the vertices of `from` to the surface `to`, vertices weighted by their area.
SurfaceDistance surface_distance(const Surface& from, const Surface& to);

}  // namespace palpate

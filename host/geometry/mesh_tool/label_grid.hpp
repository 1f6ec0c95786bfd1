// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/mesh_tool/mesh_job.hpp"

namespace palpate::mesh_tool {

/// A point on the interface between two regions.
struct InterfacePoint {
    Vec3 point;
    std::array<Index, 2> regions;
};

/// Answers, from the sampled fields of a `VolumeJob` (which must outlive it), which region a point
/// lies in and how far the next interface is. Trilinear between samples; region 0 beyond the box.
class LabelGrid {
public:
    explicit LabelGrid(const VolumeJob& job);

    Index region_at(const Vec3& point) const;
    /// Distance to the nearest interface between regions in the box, mm (approximate).
    double interface_distance(const Vec3& point) const;
    const Vec3& box_low() const { return job_->box_low; }
    const Vec3& box_high() const { return job_->box_high; }

    /// A few points on the interfaces of every connected part of every region, at least `distance`
    /// mm from each other; none on the hull.
    std::vector<InterfacePoint> interface_points(double distance) const;

private:
    struct Best {
        Index region = 0;
        double first = 0, second = 0;  ///< least and second least value
    };
    Best best_at(const Vec3& point) const;
    bool in_box(const Vec3& point) const;
    std::vector<Index> deepest_sample_of_parts() const;
    void add_crossings(const Vec3& from, double distance,
                       std::vector<InterfacePoint>& points) const;
    Vec3 sample_point(Index sample) const;

    const VolumeJob* job_;
};

}  // namespace palpate::mesh_tool

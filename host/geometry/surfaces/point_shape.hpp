// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/geometry/surfaces/orientation.hpp"
#include "host/geometry/surfaces/target_shape.hpp"

namespace palpate {

/// A cloud of points on a surface, of which only a part may have been seen. The surface near a
/// point is the plane through the closest points of the cloud (total least squares, Hoppe et al.
/// 1992, section 3.1; weighted, so that it turns without jumps as the point moves). A point that
/// does not lie over them, or faces away from them, is not seen.
class PointShape : public TargetShape {
public:
    /// `noise_mm`: standard deviation of a point about the surface. Points closer together than
    /// twice that are averaged, and a plane is wide enough to have a direction all the same. Points
    /// far from all others are left out. Throws Error(input_unusable) for fewer than 8 points.
    PointShape(std::vector<Vec3> points, const Outward& outward, double noise_mm = 0);
    ~PointShape() override;
    ShapeDistance measure(const Vec3& point, const Vec3& facing) const override;
    double measured_area_mm2() const override { return spacing_mm_ * spacing_mm_; }
    /// Median distance from a point of the cloud to its closest neighbour, mm.
    double spacing_mm() const { return spacing_mm_; }
    /// What was kept of the cloud, mm.
    const std::vector<Vec3>& points() const { return points_; }

private:
    struct Tree;
    struct Plane;
    Plane plane_at(const Vec3& point) const;
    std::vector<double> shares_of(const std::vector<Index>& near, const Vec3& point) const;
    void average(double cell_mm);
    void drop_strays();
    void orient(const Outward& outward);

    std::vector<Vec3> points_, normals_;  ///< outward normals
    std::vector<double> counts_;          ///< how many points of the cloud each is the mean of
    std::unique_ptr<Tree> tree_;
    int plane_points_;
    double spacing_mm_ = 0;
};

}  // namespace palpate

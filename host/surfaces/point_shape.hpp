// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/surfaces/target_shape.hpp"

namespace palpate {

/// A cloud of points on a surface, of which only a part may have been seen. The surface near a
/// point is the plane through the closest points of the cloud (total least squares; Hoppe et al.
/// 1992, section 3.1). A point that does not lie over them is not seen.
class PointShape : public TargetShape {
public:
    /// Throws Error(input_unusable) for fewer than 8 points.
    explicit PointShape(std::vector<Vec3> points);
    ~PointShape() override;
    ShapeDistance measure(const Vec3& point, const Vec3& facing) const override;
    /// Median distance from a point of the cloud to its closest neighbour, mm.
    double spacing_mm() const { return spacing_mm_; }

private:
    struct Tree;
    std::vector<Vec3> points_;
    std::unique_ptr<Tree> tree_;
    double spacing_mm_ = 0;
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/surfaces/surface.hpp"
#include "host/geometry/surfaces/target_shape.hpp"

namespace palpate {

/// Signed distance (mm, negative inside) to the boundary of one region, twice differentiable:
/// distances to the zero of its own level in a `LabelField` (exact up to 4 mm, some 0.02 mm off on
/// average beyond), sampled on a regular grid and interpolated by cubic B-splines. This is the
/// smooth closest point of the inverse problem: the closest point of y is y - d(y) grad d(y),
/// without the kinks of a faceted surface.
class DistanceMap : public TargetShape {
public:
    /// The map reaches `margin_mm` beyond the region's voxels; further out it continues linearly.
    /// If the region is cut by the image box, its surface is continued beyond the box (LabelField).
    /// Throws Error(input_unusable) if the region is absent or has no surface.
    DistanceMap(const LabelField& field, Index region, double margin_mm = 20.0);

    double value(const Vec3& point) const;
    double value(const Vec3& point, Vec3& gradient) const;

    ShapeDistance measure(const Vec3& point, const Vec3& facing) const override;
    bool is_of_voxels() const override { return true; }

    /// The same surface moved rigidly: map.moved(T).value(T(y)) == map.value(y).
    DistanceMap moved(const RigidTransform& transform) const;

    /// Where the samples lie; isotropic, at most about 4 million.
    const ImageGrid& grid() const { return grid_; }

private:
    double value_of(const std::vector<float>& coefficients, const Vec3& point,
                    Vec3& gradient) const;

    ImageGrid grid_;
    std::vector<float> coefficients_, smooth_;  ///< smooth: for normals
};

}  // namespace palpate

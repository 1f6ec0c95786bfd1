// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/io/image.hpp"

namespace palpate {

/// u at a point (LPS mm): linear between voxel centres, the border's value beyond them.
Vec3 displacement_at(const Image<Vec3>& field, const Vec3& point);

/// Whether a point lies in the box of voxels, that is, at most half a voxel beyond the outermost
/// centres: the rule by which ITK decides where a displacement field ends.
bool is_inside(const ImageGrid& grid, const Vec3& point);

/// Where a point comes from, and how far off that is.
struct Origin {
    Vec3 point = Vec3::Zero();
    double defect_mm = 0;  ///< |y - x - u(x)|
};

/// x with x + u(x) = y, from `start`, by x <- x + s (y - x - u(x)); s is halved when the defect
/// grows or turns round, so that fields steeper than 1 still converge where they have an inverse.
Origin origin_of(const Image<Vec3>& field, const Vec3& y, const Vec3& start, double tolerance_mm);

struct MovedPoint {
    Vec3 point = Vec3::Zero();
    bool inside = true;  ///< false where the field says nothing and its border was continued
    /// False where the field folds and nothing that was tried moves to within 1e-3 mm of the point
    /// (only for inverses): the best that was tried.
    bool found = true;
};

/// A map of points of one state to points of the other: x -> x + u(x), or the inverse of that.
struct PointMap {
    Image<Vec3> field;
    bool inverted = false;

    MovedPoint moved(const Vec3& point) const;
};

}  // namespace palpate

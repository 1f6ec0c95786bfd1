// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/displacement_field.hpp"

#include <cmath>

#include "host/geometry/warping/linear_value.hpp"

namespace palpate {
namespace {

constexpr double inversion_tolerance_mm = 1e-5;  // a hundredth of what is promised for points

}  // namespace

Vec3 displacement_at(const Image<Vec3>& field, const Vec3& point) {
    return linear_value<Vec3>(field, point);
}

bool is_inside(const ImageGrid& grid, const Vec3& point) {
    const Vec3 index = grid.to_index(point);
    for (int axis = 0; axis < 3; ++axis) {
        if (!(index[axis] >= -0.5 && index[axis] <= grid.size[axis] - 0.5)) return false;
    }
    return true;
}

Origin origin_of(const Image<Vec3>& field, const Vec3& y, const Vec3& start, double tolerance_mm) {
    constexpr int max_iterations = 100;
    constexpr double smallest_step = 0.05;
    double step = 1.0;
    Vec3 x = start;
    Vec3 defect = y - x - displacement_at(field, x);
    for (int n = 0; n < max_iterations && defect.norm() > tolerance_mm; ++n) {
        const Vec3 next = x + step * defect;
        const Vec3 next_defect = y - next - displacement_at(field, next);
        if (next_defect.norm() > defect.norm() && step > smallest_step) {
            step *= 0.5;
            continue;
        }
        const bool overshot = next_defect.dot(defect) < 0;
        if (overshot && next_defect.norm() > 0.5 * defect.norm()) step *= 0.5;
        x = next;
        defect = next_defect;
    }
    return {x, defect.norm()};
}

MovedPoint PointMap::moved(const Vec3& point) const {
    if (!inverted)
        return {point + displacement_at(field, point), is_inside(field.grid, point), true};
    constexpr double found_mm = 1e-3;
    const Origin origin = origin_of(field, point, point, inversion_tolerance_mm);
    return {origin.point, is_inside(field.grid, origin.point), origin.defect_mm < found_mm};
}

}  // namespace palpate

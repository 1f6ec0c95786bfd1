// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/warping/displacement_field.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double inversion_tolerance_mm = 1e-5;  // a hundredth of what is promised for points

}  // namespace

Vec3 displacement_at(const Image<Vec3>& field, const Vec3& point) {
    const Vec3 index = field.grid.to_index(point);
    std::array<Index, 3> low{}, high{};
    Vec3 t;
    for (int axis = 0; axis < 3; ++axis) {
        const double x = std::clamp(index[axis], 0.0, field.grid.size[axis] - 1.0);
        low[axis] = static_cast<Index>(x);
        high[axis] = std::min<Index>(low[axis] + 1, field.grid.size[axis] - 1);
        t[axis] = x - low[axis];
    }
    const auto along_i = [&](Index j, Index k) -> Vec3 {
        return (1 - t[0]) * field.at(low[0], j, k) + t[0] * field.at(high[0], j, k);
    };
    const auto along_j = [&](Index k) -> Vec3 {
        return (1 - t[1]) * along_i(low[1], k) + t[1] * along_i(high[1], k);
    };
    return (1 - t[2]) * along_j(low[2]) + t[2] * along_j(high[2]);
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
    if (!inverted) return {point + displacement_at(field, point), is_inside(field.grid, point)};
    constexpr double found_mm = 1e-3;
    const Origin origin = origin_of(field, point, point, inversion_tolerance_mm);
    return {origin.point, origin.defect_mm < found_mm && is_inside(field.grid, origin.point)};
}

}  // namespace palpate

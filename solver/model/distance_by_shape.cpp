// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/distance_by_shape.hpp"

#include <unsupported/Eigen/AutoDiff>

#include "solver/model/obstacle_depth.hpp"

namespace palpate {
namespace {

/// By y and the four sizes.
using SizeDual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 7, 1>>;

}  // namespace

DistanceByShape distance_by_shape(const Obstacle& obstacle, const Vec3& y) {
    Triple<SizeDual> at;
    for (int i = 0; i < 3; ++i) at[i] = SizeDual(y[i], 7, i);
    ObstacleSizes<SizeDual> sizes(obstacle);
    SizeDual* list[] = {&sizes.radius, &sizes.edge_radius, &sizes.outer_radius,
                        &sizes.outer_edge_radius};
    for (int k = 0; k < 4; ++k) *list[k] = SizeDual(list[k]->value(), 7, 3 + k);
    const auto found = depth_in(obstacle, sizes, at);
    DistanceByShape result;
    // d = -depth,  n = dd/dy
    result.distance_mm = -found.depth.value();
    result.by_size = -found.depth.derivatives().tail<4>().transpose();
    for (int i = 0; i < 3; ++i) {
        result.normal[i] = found.normal[i].value();
        result.curvature.row(i) = found.normal[i].derivatives().head<3>().transpose();
        result.normal_by_size.row(i) = found.normal[i].derivatives().tail<4>().transpose();
    }
    return result;
}

}  // namespace palpate

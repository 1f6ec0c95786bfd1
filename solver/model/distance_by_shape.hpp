// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solver/model/contact.hpp"

namespace palpate {

/// Where a point is with regard to an obstacle, with derivatives by the point and by the lengths
/// that shape the obstacle.
struct DistanceByShape {
    double distance_mm = 0;         ///< signed: negative inside
    Vec3 normal = Vec3::Zero();     ///< its gradient, of length 1, out of the obstacle
    Mat3 curvature = Mat3::Zero();  ///< its second derivatives, 1/mm
    Eigen::RowVector4d by_size;     ///< d(distance)/d(size k), in the order of `obstacle_sizes`
    Eigen::Matrix<double, 3, 4> normal_by_size;  ///< d(normal)/d(size k), 1/mm
};

/// At a held point y, in the frame that moves with the obstacle, mm. With the signed distance d of
/// `depth_in`, the radius a of a tube's hole and the radius e of its edge: dd/da = 1 at the bore,
/// cos t at the edge and 0 on the rim; dd/de = sin t + cos t - 1 at the edge and 0 elsewhere, t the
/// angle of the normal over the rim's plane. Sizes that the shape has not have the derivative 0.
/// Second derivatives jump where flat and round meet; on the axis of a cylinder and in the centre
/// of a sphere nothing is finite.
DistanceByShape distance_by_shape(const Obstacle& obstacle, const Vec3& y);

}  // namespace palpate

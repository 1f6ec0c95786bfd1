// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "host/apps/recover/modelling/alignment.hpp"
#include "host/apps/recover/observations/voxel_terraces.hpp"

namespace palpate {

/// A small rigid motion of the frame that the target was aligned to: rotation vector times 30 mm,
/// then translation, mm.
using FrameMotion = Eigen::Matrix<double, 6, 1>;

/// The reference frame, about a point in it (LPS mm).
struct TargetFrame {
    static constexpr double radius_mm = 30;
    Vec3 centre = Vec3::Zero();

    /// Of a point at x, to first order in the rotation.
    Vec3 displacement(const FrameMotion& motion, const Vec3& x) const {
        return motion.head<3>().cross(x - centre) / radius_mm + motion.tail<3>();
    }
    /// Of a point at x along n: row . motion = n . displacement.
    FrameMotion row(const Vec3& x, const Vec3& n) const {
        FrameMotion row;
        row << (x - centre).cross(n) / radius_mm, n;
        return row;
    }
    RigidTransform transform(const FrameMotion& motion) const {
        const Vec3 turn = motion.head<3>() / radius_mm;
        const double angle = turn.norm();
        const Mat3 rotation = angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()
                                        : Mat3(Mat3::Identity());
        return {rotation, centre - rotation * centre + motion.tail<3>()};
    }
};

/// What is known of the alignment from the points that it was made of, by least squares.
struct FrameEvidence {
    TargetFrame frame;
    std::vector<AlignedPoint> points;  ///< empty: the frame is taken to be exact
    std::vector<Terraces> terraces;    ///< of each point
    double independent_mm = 0;         ///< of each point
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/interfaces.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace palpate {

Interfaces::Interfaces(const LabelField& field, const ImageGrid& grid)
    : field_(field),
      direction_(grid.direction),
      corner_(grid.to_point(Vec3::Constant(-0.5))),
      offsets_(std::size_t(field.num_regions()), 0.0) {}

double Interfaces::value(Index region, const Vec3& point, Vec3& gradient) const {
    Vec3 lps_gradient;
    const double value = field_.value(region, to_lps(point), lps_gradient) - offsets_[region];
    gradient = direction_.transpose() * lps_gradient;
    return value;
}

Vec3 Interfaces::step_to_interface(const Vec3& point, std::span<const std::uint8_t> regions,
                                   unsigned fixed_axes, double max_step_mm) const {
    // Fields of equal slope are nearly parallel where a region ends in a wedge; the damping keeps
    // the vertex from running out along the wedge's tip.
    constexpr double damping = 0.02, curve_damping = 0.1;
    constexpr int max_equations = 4;
    const int equations = std::min(int(regions.size()) - 1, max_equations);
    if (equations < 1) return Vec3::Zero();
    Vec3 first_gradient;
    const double first_value = value(regions[0], point, first_gradient);
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, max_equations, 3> jacobian(equations, 3);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_equations, 1> residual(equations);
    for (int row = 0; row < equations; ++row) {
        Vec3 gradient;
        residual[row] = (value(regions[row + 1], point, gradient) - first_value) / 2;
        jacobian.row(row) = (gradient - first_gradient).transpose() / 2;
    }
    for (int axis = 0; axis < 3; ++axis)
        if (fixed_axes >> axis & 1u) jacobian.col(axis).setZero();
    Vec3 step;
    if (equations == 1) {
        const Vec3 slope = jacobian.row(0).transpose();
        step = -residual[0] / (slope.squaredNorm() + damping) * slope * (1 + damping);
    } else {
        Mat3 normal = jacobian.transpose() * jacobian;
        normal.diagonal().array() += curve_damping;
        step = -normal.ldlt().solve(jacobian.transpose() * residual);
    }
    const double length = step.norm();
    return length > max_step_mm ? Vec3(step * (max_step_mm / length)) : step;
}

}  // namespace palpate

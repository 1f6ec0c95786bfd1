// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>

#include "solver/base/types.hpp"
#include "solver/elements/element_shape.hpp"
#include "solver/elements/simplex_shapes.hpp"

namespace palpate {

/// Linear tetrahedron: constant gradients of its four shape functions (1/mm) and volume (mm^3).
struct Tet4 {
    std::array<Vec3, 4> gradient;
    double volume = 0;
};

/// Shape functions N_a with N_a(p_b) = delta_ab: the rows of J^-1, J = [p1-p0, p2-p0, p3-p0], are
/// the gradients of N_1, N_2, N_3, and the four gradients add up to zero.
inline Tet4 tet4_geometry(const Vec3& p0, const Vec3& p1, const Vec3& p2, const Vec3& p3) {
    Mat3 jacobian;
    jacobian << p1 - p0, p2 - p0, p3 - p0;
    const Mat3 inverse = jacobian.inverse();
    Tet4 tet;
    for (int a = 0; a < 3; ++a) tet.gradient[a + 1] = inverse.row(a).transpose();
    tet.gradient[0] = -(tet.gradient[1] + tet.gradient[2] + tet.gradient[3]);
    tet.volume = jacobian.determinant() / 6.0;
    return tet;
}

/// Block (a, b) of the element stiffness of Hooke's law with Lame parameters lambda, mu (kPa):
///   V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I),   mN/mm
inline Mat3 tet4_stiffness_block(const Tet4& tet, int a, int b, double lambda, double mu) {
    const Vec3& ga = tet.gradient[a];
    const Vec3& gb = tet.gradient[b];
    Mat3 block = lambda * ga * gb.transpose() + mu * gb * ga.transpose();
    block.diagonal().array() += mu * ga.dot(gb);
    return tet.volume * block;
}

using Tet4Stiffness = Eigen::Matrix<double, 12, 12>;

/// The whole element stiffness, row and column 3 a + c for component c of corner a.
inline Tet4Stiffness tet4_stiffness(const Tet4& tet, double lambda, double mu) {
    Tet4Stiffness stiffness;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
            stiffness.block<3, 3>(3 * a, 3 * b) = tet4_stiffness_block(tet, a, b, lambda, mu);
    return stiffness;
}

/// Linear tetrahedron, one point.
inline ElementShape tet4_shape() {
    static constexpr double place[] = {0.25, 0.25, 0.25};
    static constexpr double weight[] = {1.0 / 6};
    static constexpr double reference[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    return {"tet4",
            3,
            4,
            4,
            linear_simplex<3>,
            reference,
            place,
            weight,
            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

}  // namespace palpate

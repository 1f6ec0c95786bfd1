// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <math.h>

#include "solver/base/tensor3.hpp"

namespace palpate {

/// Limits of a valid state, alike in every precision: below and above them single precision has
/// lost the state, and no tissue gets there.
constexpr double smallest_volume_ratio = 1e-6;
constexpr double largest_square_stretch = 1e4;
constexpr double largest_stress_kpa = 1e15;

/// Strain measures of F = I + H that stay exact in relative terms as H goes to zero. With the
/// Green strain E = (H + H^T + H^T H) / 2 and C = F^T F = I + 2 E:
template <typename Real>
struct FiniteStrain {
    Tensor3<Real> f;                   ///< F
    Tensor3<Real> inverse_transposed;  ///< F^-T
    Tensor3<Real> twice_deviator;      ///< 2 e = 2 (E - t I)
    Real mean;                         ///< t = tr E / 3
    Real square_stretch;               ///< 1 + 2 t = I1 / 3
    Real volume_change;                ///< J - 1
    Real log_volume;                   ///< ln J
    Real log_distortion;               ///< ln (I3 / (I1 / 3)^3) <= 0, zero without distortion
    bool is_valid;
};

/// x - ln(1 + x) for x > -1. Near zero by r = x / (2 + x), ln(1 + x) = 2 (r + r^3/3 + r^5/5 + ..),
/// so that x - ln(1 + x) = r (x - 2 r^2 (1/3 + r^2/5 + ..)) without cancellation.
template <typename Real>
PALPATE_DEVICE Real minus_log1p(Real x) {
    if (!(fabs(x) < Real(0.25))) return x - log1p(x);
    const Real r = x / (2 + x);
    const Real r2 = r * r;
    Real series = 0;
    for (int n = 23; n >= 3; n -= 2) series = series * r2 + Real(1) / n;
    return r * (x - 2 * r2 * series);
}

/// ln det(I + epsilon) with the traceless epsilon = 2 e / (1 + 2 t): det - 1 = -epsilon:epsilon/2 +
/// det epsilon. Where that comes close to -1, from J and t, which do not cancel there.
template <typename Real>
PALPATE_DEVICE Real log_distortion(const FiniteStrain<Real>& s) {
    const Tensor3<Real> epsilon = scaled(s.twice_deviator, 1 / s.square_stretch);
    const Tensor3<Real> c = cofactors(epsilon);
    const Real determinant = epsilon.m[0] * c.m[0] + epsilon.m[1] * c.m[1] + epsilon.m[2] * c.m[2];
    const Real change = determinant - double_dot(epsilon, epsilon) / 2;
    if (change > Real(-0.5)) return log1p(change);
    return 2 * s.log_volume - 3 * log(s.square_stretch);
}

/// Strain of the displacement gradient H, and whether it is valid.
template <typename Real>
PALPATE_DEVICE FiniteStrain<Real> strain_within_limits(const Tensor3<Real>& h) {
    FiniteStrain<Real> s;
    s.f = h;
    add_diagonal(s.f, Real(1));
    s.volume_change = determinant_change(h);
    s.inverse_transposed = scaled(cofactors(s.f), 1 / (1 + s.volume_change));
    s.twice_deviator = transposed_times(h, h);
    const Tensor3<Real> linear = twice_symmetric_part(h);
    for (int i = 0; i < 9; ++i) s.twice_deviator.m[i] += linear.m[i];
    s.mean = trace(s.twice_deviator) / 6;
    add_diagonal(s.twice_deviator, -2 * s.mean);
    s.square_stretch = 1 + 2 * s.mean;
    s.is_valid = 1 + s.volume_change > Real(smallest_volume_ratio) && s.square_stretch > 0 &&
                 s.square_stretch < Real(largest_square_stretch);
    s.log_volume = log1p(s.volume_change);
    s.log_distortion = log_distortion(s);
    return s;
}

/// The same for any H: a state that is not valid is replaced by the state of rest, with `is_valid`
/// false, so that nothing computed from it is NaN.
template <typename Real>
PALPATE_DEVICE FiniteStrain<Real> finite_strain(const Tensor3<Real>& h) {
    FiniteStrain<Real> s = strain_within_limits(h);
    if (s.is_valid) return s;
    s = strain_within_limits(Tensor3<Real>{});
    s.is_valid = false;
    return s;
}

}  // namespace palpate

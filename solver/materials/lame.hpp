// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// Lame's moduli (kPa) of a Young's modulus E and a Poisson's ratio nu, and their derivatives by E
/// (entry 0) and nu (entry 1). Made in fp64: 1 - 2 nu has few digits in fp32.
template <typename Real>
struct LameModuli {
    Real mu;
    Real lambda;
    Real mu_slope[2];
    Real lambda_slope[2];
};

template <typename Real>
LameModuli<Real> lame_moduli(double stiffness_kpa, double poisson_ratio) {
    const double nu = poisson_ratio;
    const double divisor = (1 + nu) * (1 - 2 * nu);
    const double mu = 0.5 * stiffness_kpa / (1 + nu);
    const double lambda = stiffness_kpa * nu / divisor;
    return {static_cast<Real>(mu),
            static_cast<Real>(lambda),
            {static_cast<Real>(mu / stiffness_kpa), static_cast<Real>(-mu / (1 + nu))},
            {static_cast<Real>(lambda / stiffness_kpa),
             static_cast<Real>(stiffness_kpa * (1 + 2 * nu * nu) / (divisor * divisor))}};
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/material.hpp"
#include "solver/materials/reduced_invariants.hpp"

namespace palpate {

/// Reduced polynomial of second order, W = C1 x + C2 x^2 + (J - 1)^2 / D1.
template <typename Real>
struct ReducedPolynomialLaw : ReducedLaw<ReducedPolynomialLaw<Real>, Real> {
    Real c1;
    Real c2;
    Real kappa;        ///< 2 / D1
    Real kappa_by_d1;  ///< its derivative

    static MaterialDescription description() {
        return {"reduced-polynomial",
                "Reduced polynomial of second order: C1 (J1 - 3) + C2 (J1 - 3)^2 + (J - 1)^2 / D1.",
                {{"c1_kpa", "kPa", above(0), "half the shear modulus at small strains", 1.5},
                 {"c2_kpa", "kPa", at_least(0), "stiffening with distortion", 1.5},
                 {"d1_per_kpa", "1/kPa", above(0), "twice the compressibility at small strains",
                  0.002}}};
    }
    static ReducedPolynomialLaw from_parameters(const double* values) {
        ReducedPolynomialLaw law;
        law.c1 = static_cast<Real>(values[0]);
        law.c2 = static_cast<Real>(values[1]);
        law.kappa = static_cast<Real>(2 / values[2]);
        law.kappa_by_d1 = static_cast<Real>(-2 / (values[2] * values[2]));
        return law;
    }
    static SmallStrainModuli small_strain(const double* values) {
        return moduli_of_shear_and_bulk(2 * values[0], 2 / values[2]);
    }
    /// C2 = C1, as among the typical values.
    static std::vector<double> parameters_of(const SmallStrainModuli& moduli) {
        const double c1 = shear_modulus(moduli) / 2;
        return {c1, c1, 2 / bulk_modulus(moduli)};
    }

    /// psi of the isochoric part, psi(x).
    PALPATE_DEVICE Potential<Real> potential(Real x) const {
        // psi = C1 x + C2 x^2, psi' = C1 + 2 C2 x, psi'' = 2 C2
        return {x * (c1 + c2 * x), c1 + 2 * c2 * x, 2 * c2};
    }
    PALPATE_DEVICE PotentialSlope<Real> potential_slope(Real x, int k) const {
        // By C1, C2 and D1; kappa = 2 / D1
        if (k == 0) return {x, Real(1)};
        if (k == 1) return {x * x, 2 * x};
        return {Real(0), Real(0)};
    }
    PALPATE_DEVICE Real kappa_slope(int k) const { return k == 2 ? kappa_by_d1 : Real(0); }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/material.hpp"
#include "solver/materials/reduced_invariants.hpp"

namespace palpate {

/// Law of Yeoh (1993) in reduced invariants, W = C1 x + C2 x^2 + C3 x^3 + kappa/2 (J - 1)^2. C2 and
/// C3 not below 0: soft tissue stiffens, and psi' > 0 then holds for every x.
template <typename Real>
struct YeohLaw : ReducedLaw<YeohLaw<Real>, Real> {
    Real c1;
    Real c2;
    Real c3;
    Real kappa;

    static MaterialDescription description() {
        return {"yeoh",
                "Yeoh: C1 (J1 - 3) + C2 (J1 - 3)^2 + C3 (J1 - 3)^3 + kappa/2 (J - 1)^2.",
                {{"c1_kpa", "kPa", above(0), "half the shear modulus at small strains", 1.5},
                 {"c2_kpa", "kPa", at_least(0), "stiffening with distortion", 1.5},
                 {"c3_kpa", "kPa", at_least(0), "stiffening with large distortion", 1.5},
                 {"kappa_kpa", "kPa", above(0), "bulk modulus at small strains", 1000}}};
    }
    static YeohLaw from_parameters(const double* values) {
        YeohLaw law;
        law.c1 = static_cast<Real>(values[0]);
        law.c2 = static_cast<Real>(values[1]);
        law.c3 = static_cast<Real>(values[2]);
        law.kappa = static_cast<Real>(values[3]);
        return law;
    }
    static SmallStrainModuli small_strain(const double* values) {
        return moduli_of_shear_and_bulk(2 * values[0], values[3]);
    }
    /// C3 = C2 = C1, as among the typical values.
    static std::vector<double> parameters_of(const SmallStrainModuli& moduli) {
        const double c1 = shear_modulus(moduli) / 2;
        return {c1, c1, c1, bulk_modulus(moduli)};
    }

    /// psi of the isochoric part, psi(x).
    PALPATE_DEVICE Potential<Real> potential(Real x) const {
        // psi = C1 x + C2 x^2 + C3 x^3, psi' = C1 + 2 C2 x + 3 C3 x^2, psi'' = 2 C2 + 6 C3 x
        return {x * (c1 + x * (c2 + x * c3)), c1 + x * (2 * c2 + 3 * x * c3), 2 * c2 + 6 * x * c3};
    }
    PALPATE_DEVICE PotentialSlope<Real> potential_slope(Real x, int k) const {
        // By C1, C2, C3 and kappa
        if (k == 0) return {x, Real(1)};
        if (k == 1) return {x * x, 2 * x};
        if (k == 2) return {x * x * x, 3 * x * x};
        return {Real(0), Real(0)};
    }
    PALPATE_DEVICE Real kappa_slope(int k) const { return Real(k == 3 ? 1 : 0); }
};

}  // namespace palpate

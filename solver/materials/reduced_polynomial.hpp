// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/material.hpp"
#include "solver/materials/reduced_invariants.hpp"

namespace palpate {

/// Reduced polynomial of second order, W = C1 x + C2 x^2 + (J - 1)^2 / D1.
template <typename Real>
struct ReducedPolynomialLaw : FiniteStrainLaw<ReducedPolynomialLaw<Real>, Real> {
    Real c1;
    Real c2;
    Real kappa;        ///< 2 / D1
    Real kappa_slope;  ///< by D1

    static MaterialDescription description() {
        return {"reduced-polynomial",
                "Reduced polynomial of second order: C1 (J1 - 3) + C2 (J1 - 3)^2 + (J - 1)^2 / D1.",
                {{"c1_kpa", "kPa", above(0), "half the shear modulus at small strains"},
                 {"c2_kpa", "kPa", at_least(0), "stiffening with distortion"},
                 {"d1_per_kpa", "1/kPa", above(0), "twice the compressibility at small strains"}}};
    }
    static ReducedPolynomialLaw from_parameters(const double* values) {
        ReducedPolynomialLaw law;
        law.c1 = static_cast<Real>(values[0]);
        law.c2 = static_cast<Real>(values[1]);
        law.kappa = static_cast<Real>(2 / values[2]);
        law.kappa_slope = static_cast<Real>(-2 / (values[2] * values[2]));
        return law;
    }
    static SmallStrainModuli small_strain(const double* values) {
        return moduli_of_shear_and_bulk(2 * values[0], 2 / values[2]);
    }

    PALPATE_DEVICE Response<Real> response(const FiniteStrain<Real>& strain) const {
        const Real x = distortion(strain);
        // psi = C1 x + C2 x^2, psi' = C1 + 2 C2 x, psi'' = 2 C2
        return reduced_response(strain, x,
                                Potential<Real>{x * (c1 + c2 * x), c1 + 2 * c2 * x, 2 * c2}, kappa);
    }

    PALPATE_DEVICE ParameterResponse<Real> parameter_response(const FiniteStrain<Real>& strain,
                                                              int k) const {
        const Real x = distortion(strain);
        // By C1, C2 and D1; kappa = 2 / D1
        if (k == 0) return reduced_parameter_response(strain, x, x, Real(1), Real(0));
        if (k == 1) return reduced_parameter_response(strain, x, x * x, 2 * x, Real(0));
        return reduced_parameter_response(strain, x, Real(0), Real(0), kappa_slope);
    }
};

}  // namespace palpate

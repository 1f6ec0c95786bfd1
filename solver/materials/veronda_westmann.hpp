// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/material.hpp"
#include "solver/materials/reduced_invariants.hpp"

namespace palpate {

/// (y e^y - e^y + 1) / y^2, by its series sum y^k / (k! (k + 2)) where the difference cancels.
template <typename Real>
PALPATE_DEVICE Real exponential_moment(Real y) {
    if (!(fabs(y) < Real(0.5))) return (y * exp(y) - expm1(y)) / (y * y);
    Real series = 0;
    for (int k = 14; k > 0; --k) series = (series + Real(1) / (k + 2)) * y / k;
    return series + Real(0.5);
}

/// Exponential law of the type of Veronda and Westmann (1970) in reduced invariants,
///   W = mu/gamma (exp(gamma x) - 1) + kappa/2 (J - 1)^2.
template <typename Real>
struct VerondaWestmannLaw : ReducedLaw<VerondaWestmannLaw<Real>, Real> {
    static constexpr double typical_gamma = 5;

    Real mu;
    Real gamma;
    Real kappa;

    static MaterialDescription description() {
        return {"veronda-westmann",
                "Veronda-Westmann type: mu/gamma (exp(gamma (J1 - 3)) - 1) + kappa/2 (J - 1)^2.",
                {{"mu_kpa", "kPa", above(0), "half the shear modulus at small strains", 1.5},
                 {"gamma", "1", above(0), "how fast the tissue stiffens with distortion",
                  typical_gamma},
                 {"kappa_kpa", "kPa", above(0), "bulk modulus at small strains", 1000}}};
    }
    static VerondaWestmannLaw from_parameters(const double* values) {
        VerondaWestmannLaw law;
        law.mu = static_cast<Real>(values[0]);
        law.gamma = static_cast<Real>(values[1]);
        law.kappa = static_cast<Real>(values[2]);
        return law;
    }
    static SmallStrainModuli small_strain(const double* values) {
        return moduli_of_shear_and_bulk(2 * values[0], values[2]);
    }
    static std::vector<double> parameters_of(const SmallStrainModuli& moduli) {
        return {shear_modulus(moduli) / 2, typical_gamma, bulk_modulus(moduli)};
    }

    /// psi of the isochoric part, psi(x).
    PALPATE_DEVICE Potential<Real> potential(Real x) const {
        const Real growth = expm1(gamma * x);
        // psi = mu/gamma (e^(gamma x) - 1), psi' = mu e^(gamma x), psi'' = gamma psi'
        const Real first = mu * (1 + growth);
        return {mu / gamma * growth, first, gamma * first};
    }
    PALPATE_DEVICE PotentialSlope<Real> potential_slope(Real x, int k) const {
        const Real growth = expm1(gamma * x);
        // By mu, gamma and kappa: psi and psi' are linear in mu,
        //   d psi/d gamma = mu (gamma x e^(gamma x) - e^(gamma x) + 1) / gamma^2,
        //   d psi'/d gamma = mu x e^(gamma x)
        if (k == 0) return {growth / gamma, 1 + growth};
        if (k == 1) return {mu * x * x * exponential_moment(gamma * x), mu * x * (1 + growth)};
        return {Real(0), Real(0)};
    }
    PALPATE_DEVICE Real kappa_slope(int k) const { return Real(k == 2 ? 1 : 0); }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/material.hpp"
#include "solver/materials/reduced_invariants.hpp"

namespace palpate {

/// Neo-Hookean law in reduced invariants, W = mu x + kappa/2 (J - 1)^2.
template <typename Real>
struct NeoHookeanReducedLaw : ReducedLaw<NeoHookeanReducedLaw<Real>, Real> {
    Real mu;
    Real kappa;

    static MaterialDescription description() {
        return {"neo-hookean-reduced",
                "Neo-Hookean in reduced invariants: mu (J1 - 3) + kappa/2 (J - 1)^2.",
                {{"mu_kpa", "kPa", above(0), "half the shear modulus at small strains", 1.5},
                 {"kappa_kpa", "kPa", above(0), "bulk modulus at small strains", 1000}}};
    }
    static NeoHookeanReducedLaw from_parameters(const double* values) {
        NeoHookeanReducedLaw law;
        law.mu = static_cast<Real>(values[0]);
        law.kappa = static_cast<Real>(values[1]);
        return law;
    }
    static SmallStrainModuli small_strain(const double* values) {
        return moduli_of_shear_and_bulk(2 * values[0], values[1]);
    }
    static std::vector<double> parameters_of(const SmallStrainModuli& moduli) {
        return {shear_modulus(moduli) / 2, bulk_modulus(moduli)};
    }

    /// psi of the isochoric part, psi(x) = mu x.
    PALPATE_DEVICE Potential<Real> potential(Real x) const { return {mu * x, mu, Real(0)}; }
    PALPATE_DEVICE PotentialSlope<Real> potential_slope(Real x, int k) const {
        // By mu and kappa
        if (k == 0) return {x, Real(1)};
        return {Real(0), Real(0)};
    }
    PALPATE_DEVICE Real kappa_slope(int k) const { return Real(k); }
};

}  // namespace palpate

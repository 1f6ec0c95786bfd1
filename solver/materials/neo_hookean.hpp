// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/finite_strain_law.hpp"
#include "solver/materials/lame.hpp"
#include "solver/materials/material.hpp"
#include "solver/materials/reduced_invariants.hpp"

namespace palpate {

/// Compressible neo-Hookean law,
///   W = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2,   F^T P = 2 mu E + lambda ln J I.
template <typename Real>
struct NeoHookeanLaw : FiniteStrainLaw<NeoHookeanLaw<Real>, Real> {
    LameModuli<Real> lame;

    /// Poisson's ratio from 0: with a negative lambda the energy of a collapsing volume has no
    /// lower bound.
    static MaterialDescription description() {
        return {"neo-hookean",
                "Compressible neo-Hookean: mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2.",
                {{"stiffness_kpa", "kPa", above(0), "Young's modulus at small strains", 10},
                 {"poisson_ratio",
                  "1",
                  {.lowest = 0, .highest = 0.5, .includes_lowest = true},
                  "Poisson's ratio at small strains"}}};
    }
    static NeoHookeanLaw from_parameters(const double* values) {
        NeoHookeanLaw law;
        law.lame = lame_moduli<Real>(values[0], values[1]);
        return law;
    }
    static SmallStrainModuli small_strain(const double* values) { return {values[0], values[1]}; }
    static std::vector<double> parameters_of(const SmallStrainModuli& moduli) {
        return {moduli.stiffness_kpa, moduli.poisson_ratio};
    }

    /// I1 - 3 - 2 ln J = 3 (2 t - ln(1 + 2 t)) - ln (I3 / (I1/3)^3), two parts of one sign.
    PALPATE_DEVICE static Real distortion_energy(const FiniteStrain<Real>& strain) {
        return 3 * minus_log1p(2 * strain.mean) - strain.log_distortion;
    }

    PALPATE_DEVICE Response<Real> response(const FiniteStrain<Real>& strain) const {
        const ParameterResponse<Real> r = of_moduli(strain, lame.mu, lame.lambda);
        // a = mu is constant; db = lambda d ln J + 2 mu dt (method.md, 8.1)
        return {r.energy, r.shear, 0, 0, r.pressure, lame.lambda, 2 * lame.mu};
    }

    PALPATE_DEVICE ParameterResponse<Real> parameter_response(const FiniteStrain<Real>& strain,
                                                              int k) const {
        return of_moduli(strain, lame.mu_slope[k], lame.lambda_slope[k]);
    }

    /// psi of the isochoric part: mu/2 (J1 - 3) is the energy of J^(-1/3) F.
    PALPATE_DEVICE Potential<Real> potential(Real x) const {
        return {lame.mu / 2 * x, lame.mu / 2, Real(0)};
    }
    PALPATE_DEVICE PotentialSlope<Real> potential_slope(Real x, int k) const {
        return {lame.mu_slope[k] / 2 * x, lame.mu_slope[k] / 2};
    }

private:
    PALPATE_DEVICE static ParameterResponse<Real> of_moduli(const FiniteStrain<Real>& strain,
                                                            Real mu, Real lambda) {
        const Real log_volume = strain.log_volume;
        // W = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2, a = mu, b = 2 mu t + lambda ln J
        // (method.md,
        // 8.1); linear in mu and lambda, so that the slopes are these of dmu/dp, dlambda/dp.
        return {mu / 2 * distortion_energy(strain) + lambda / 2 * log_volume * log_volume, mu,
                2 * mu * strain.mean + lambda * log_volume};
    }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <math.h>

#include "solver/materials/lame.hpp"
#include "solver/materials/material.hpp"

namespace palpate {

template <typename Real>
struct SmallStrainState {
    Tensor3<Real> twice_strain;  ///< H + H^T
    bool is_valid;               ///< false only for numbers that are not finite
};

/// Hooke's law at small strains as one of the laws: W = stress : sym(H) / 2,
/// P = lambda tr(H) I + 2 mu sym(H). Not objective: for rotations below some degrees.
template <typename Real>
struct LinearLaw {
    using Number = Real;
    using State = SmallStrainState<Real>;

    LameModuli<Real> lame;

    static MaterialDescription description() {
        return {
            "linear",
            "Hooke's law for small strains and rotations: lambda/2 tr(e)^2 + mu e:e.",
            {{"stiffness_kpa", "kPa", above(0), "Young's modulus", 10},
             {"poisson_ratio", "1", {.lowest = -1, .highest = 0.5}, "Poisson's ratio", 0.4, 1}}};
    }
    static LinearLaw from_parameters(const double* values) {
        return {lame_moduli<Real>(values[0], values[1])};
    }
    static SmallStrainModuli small_strain(const double* values) { return {values[0], values[1]}; }
    static std::vector<double> parameters_of(const SmallStrainModuli& moduli) {
        return {moduli.stiffness_kpa, moduli.poisson_ratio};
    }

    PALPATE_DEVICE State state(const Tensor3<Real>& h) const {
        State s{twice_symmetric_part(h), true};
        Real size = 0;
        for (int i = 0; i < 9; ++i) size += fabs(s.twice_strain.m[i]);
        s.is_valid = size < Real(1e10);
        if (!s.is_valid) s.twice_strain = Tensor3<Real>{};
        return s;
    }

    PALPATE_DEVICE Real energy(const State& s) const {
        return s.is_valid ? energy_of(s, lame.mu, lame.lambda) : Real(HUGE_VAL);
    }
    PALPATE_DEVICE Tensor3<Real> stress(const State& s) const {
        return stress_of(s.twice_strain, lame.mu, lame.lambda);
    }
    PALPATE_DEVICE Tensor3<Real> tangent_apply(const State& s, const Tensor3<Real>& df) const {
        if (!s.is_valid) return Tensor3<Real>{};
        return stress_of(twice_symmetric_part(df), lame.mu, lame.lambda);
    }
    PALPATE_DEVICE Real parameter_energy(const State& s, int k) const {
        return energy_of(s, lame.mu_slope[k], lame.lambda_slope[k]);
    }
    PALPATE_DEVICE Tensor3<Real> parameter_stress(const State& s, int k) const {
        return stress_of(s.twice_strain, lame.mu_slope[k], lame.lambda_slope[k]);
    }

private:
    PALPATE_DEVICE static Real energy_of(const State& s, Real mu, Real lambda) {
        // W = stress : e / 2; `stress_of` gives the stress of e for 2 e, hence 4
        return double_dot(stress_of(s.twice_strain, mu, lambda), s.twice_strain) / 4;
    }
    PALPATE_DEVICE static Tensor3<Real> stress_of(const Tensor3<Real>& twice_strain, Real mu,
                                                  Real lambda) {
        // 2 mu e + lambda tr(e) I
        Tensor3<Real> stress = scaled(twice_strain, mu);
        add_diagonal(stress, lambda / 2 * trace(twice_strain));
        return stress;
    }
};

/// Laws whose stress knows no difference between the Piola stresses.
template <class Law>
inline constexpr bool is_small_strain = false;
template <typename Real>
inline constexpr bool is_small_strain<LinearLaw<Real>> = true;

}  // namespace palpate

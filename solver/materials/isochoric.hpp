// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/finite_strain_law.hpp"
#include "solver/materials/linear_law.hpp"
#include "solver/materials/reduced_invariants.hpp"

// What a law stores in changes of shape: W_iso(F) = W(J^(-1/3) F), a function psi(x) of x = J1 - 3
// for all laws here (Holzapfel, Nonlinear Solid Mechanics, 2000, equation 6.85). Of Hooke's law it
// is mu dev e : dev e. A law of large strains says what its psi is by `potential(x)` and
// `potential_slope(x, k)`.
namespace palpate {

/// a + factor b, as energies add up.
template <typename Real>
Response<Real> sum_of_responses(const Response<Real>& a, Real factor, const Response<Real>& b) {
    return {a.energy + factor * b.energy,
            a.shear + factor * b.shear,
            a.shear_by_distortion + factor * b.shear_by_distortion,
            a.shear_by_volume + factor * b.shear_by_volume,
            a.pressure + factor * b.pressure,
            a.pressure_by_volume + factor * b.pressure_by_volume,
            a.pressure_by_strain + factor * b.pressure_by_strain};
}

/// W_iso alone, with the interface of a law.
template <class Law, typename Real>
struct IsochoricPart : FiniteStrainLaw<IsochoricPart<Law, Real>, Real> {
    Law law;

    explicit IsochoricPart(const Law& of) : law(of) {}

    Response<Real> response(const FiniteStrain<Real>& strain) const {
        const Real x = distortion(strain);
        return reduced_response(strain, x, law.potential(x), Real(0));
    }
    ParameterResponse<Real> parameter_response(const FiniteStrain<Real>& strain, int k) const {
        const Real x = distortion(strain);
        return reduced_parameter_response(strain, x, law.potential_slope(x, k), Real(0));
    }
};

/// W + (factor - 1) W_iso, with the interface of a law.
template <class Law, typename Real>
struct IsochoricallyScaled : FiniteStrainLaw<IsochoricallyScaled<Law, Real>, Real> {
    IsochoricPart<Law, Real> part;
    Real factor;

    IsochoricallyScaled(const Law& of, Real by) : part(of), factor(by) {}

    Response<Real> response(const FiniteStrain<Real>& strain) const {
        return sum_of_responses(part.law.response(strain), factor - 1, part.response(strain));
    }
    ParameterResponse<Real> parameter_response(const FiniteStrain<Real>& strain, int k) const {
        ParameterResponse<Real> sum = part.law.parameter_response(strain, k);
        const ParameterResponse<Real> more = part.parameter_response(strain, k);
        sum.energy += (factor - 1) * more.energy;
        sum.shear += (factor - 1) * more.shear;
        sum.pressure += (factor - 1) * more.pressure;
        return sum;
    }
};

template <class Law>
auto isochoric_part(const Law& law) {
    return IsochoricPart<Law, typename Law::Number>(law);
}
template <class Law>
auto isochorically_scaled(const Law& law, double factor) {
    using Real = typename Law::Number;
    return IsochoricallyScaled<Law, Real>(law, static_cast<Real>(factor));
}
/// The state of the part where the scaled law has the state s.
template <class Part, typename Real>
auto part_state(const Part& part, const FiniteStrainState<Real>& s) {
    return part.state_of(s.strain);
}

/// Hooke's law without a bulk modulus, lambda = -2 mu / 3.
template <typename Real>
LinearLaw<Real> isochoric_part(const LinearLaw<Real>& law) {
    LinearLaw<Real> part = law;
    part.lame.lambda = -2 * law.lame.mu / 3;
    for (int k = 0; k < 2; ++k) part.lame.lambda_slope[k] = -2 * law.lame.mu_slope[k] / 3;
    return part;
}
template <typename Real>
LinearLaw<Real> isochorically_scaled(const LinearLaw<Real>& law, double factor) {
    const LinearLaw<Real> part = isochoric_part(law);
    const auto more = static_cast<Real>(factor - 1);
    LinearLaw<Real> scaled = law;
    scaled.lame.mu += more * part.lame.mu;
    scaled.lame.lambda += more * part.lame.lambda;
    for (int k = 0; k < 2; ++k) {
        scaled.lame.mu_slope[k] += more * part.lame.mu_slope[k];
        scaled.lame.lambda_slope[k] += more * part.lame.lambda_slope[k];
    }
    return scaled;
}
template <typename Real>
SmallStrainState<Real> part_state(const LinearLaw<Real>&, const SmallStrainState<Real>& s) {
    return s;
}

}  // namespace palpate

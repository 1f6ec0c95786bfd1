// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/materials/finite_strain.hpp"

namespace palpate {

/// What a hyperelastic law is at one state. Every isotropic law here has the Mandel stress
///   F^T P = shear 2 e + pressure I,
/// and with M = F^-1 dF, g = tr M = d ln J and dt = tr dE / 3 the changes
///   d shear = shear_by_distortion (2 e : M) + shear_by_volume g,
///   d pressure = pressure_by_volume g + pressure_by_strain dt.     All in kPa.
template <typename Real>
struct Response {
    Real energy;
    Real shear;
    Real shear_by_distortion;
    Real shear_by_volume;
    Real pressure;
    Real pressure_by_volume;
    Real pressure_by_strain;
};

/// Derivatives of a response by one parameter.
template <typename Real>
struct ParameterResponse {
    Real energy;
    Real shear;
    Real pressure;
};

template <typename Real>
struct FiniteStrainState {
    FiniteStrain<Real> strain;
    Response<Real> response;
    bool is_valid;
};

/// From a response to energy, stress and tangent, the same for every law. A law derives from it and
/// has `response(strain)` and `parameter_response(strain, k)`.
/// (Holzapfel, Nonlinear Solid Mechanics, 2000, chapter 6, in other variables.)
template <class Law, typename Real>
struct FiniteStrainLaw {
    using Number = Real;
    using State = FiniteStrainState<Real>;

    PALPATE_DEVICE State state(const Tensor3<Real>& h) const { return state_of(finite_strain(h)); }

    /// The same for a strain that is there already.
    PALPATE_DEVICE State state_of(const FiniteStrain<Real>& strain) const {
        State s;
        s.strain = strain;
        s.response = law().response(s.strain);
        s.is_valid = s.strain.is_valid;
        const Tensor3<Real> p = stress(s);
        Real size = 0;
        // sum |P_ij| within limits; not so for NaN, whose comparisons are false
        for (int i = 0; i < 9; ++i) size += fabs(p.m[i]);
        s.is_valid = s.is_valid && size < Real(largest_stress_kpa);  // false for NaN
        if (!s.is_valid) s.response = {Real(HUGE_VAL), 0, 0, 0, 0, 0, 0};
        return s;
    }

    PALPATE_DEVICE Real energy(const State& s) const { return s.response.energy; }

    PALPATE_DEVICE Tensor3<Real> stress(const State& s) const {
        return mandel_to_piola(s, s.response.shear, s.response.pressure);
    }

    /// dP = F^-T (d(F^T P) - M^T F^T P).
    PALPATE_DEVICE Tensor3<Real> tangent_apply(const State& s, const Tensor3<Real>& df) const {
        const Tensor3<Real>& twice_e = s.strain.twice_deviator;
        const Response<Real>& r = s.response;
        // M = F^-1 dF, 2 dE = F^T dF + dF^T F, g = tr M = d ln J, dt = tr dE / 3
        const Tensor3<Real> m = transposed_times(s.strain.inverse_transposed, df);
        const Tensor3<Real> twice_de = twice_symmetric_part(transposed_times(s.strain.f, df));
        const Real g = trace(m);
        const Real dt = trace(twice_de) / 6;
        // d shear and d pressure as in `Response`
        const Real d_shear = r.shear_by_distortion * double_dot(twice_e, m) + r.shear_by_volume * g;
        const Real d_pressure = r.pressure_by_volume * g + r.pressure_by_strain * dt;

        // d(F^T P) - M^T F^T P with F^T P = shear 2 e + pressure I and d(2 e) = 2 dE - 2 dt I:
        //   d shear 2 e + shear (2 dE - M^T 2 e) - pressure M^T + (d pressure - 2 dt shear) I
        Tensor3<Real> d = transposed_times(m, twice_e);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const int ij = 3 * i + j;
                d.m[ij] = d_shear * twice_e.m[ij] + r.shear * (twice_de.m[ij] - d.m[ij]) -
                          r.pressure * m.m[3 * j + i];
            }
        add_diagonal(d, d_pressure - 2 * dt * r.shear);
        return times(s.strain.inverse_transposed, d);
    }

    /// Column e: dP by entry entries[e] = 3 i + k of dF, of those entries [count] of P alone. With
    /// G = F^-T, W = G 2 e and Q = shear (F - W) - pressure G the products of `tangent_apply` are
    ///   dP_ab = shear d_ai d_bk + (shear_by_distortion W_ik + shear_by_volume G_ik) W_ab
    ///         + (pressure_by_volume G_ik + (pressure_by_strain - 2 shear) F_ik / 3) G_ab
    ///         + G_ak Q_ib.
    PALPATE_DEVICE void moduli(const State& s, const int* entries, int count,
                               Tensor3<Real>* columns) const {
        const Response<Real>& r = s.response;
        const Tensor3<Real>&f = s.strain.f, &g = s.strain.inverse_transposed;
        const Tensor3<Real> w = times(g, s.strain.twice_deviator);
        const Tensor3<Real> q = sum_of(Real(1), sum_of(r.shear, f, -r.shear, w), -r.pressure, g);
        const Real by_strain = (r.pressure_by_strain - 2 * r.shear) / 3;
        for (int e = 0; e < count; ++e) {
            const int ik = entries[e], i = 3 * (ik / 3), k = ik % 3;
            const Real on_w = r.shear_by_distortion * w.m[ik] + r.shear_by_volume * g.m[ik];
            const Real on_g = r.pressure_by_volume * g.m[ik] + by_strain * f.m[ik];
            for (int h = 0; h < count; ++h) {
                const int ab = entries[h], a = 3 * (ab / 3), b = ab % 3;
                columns[e].m[ab] = on_w * w.m[ab] + on_g * g.m[ab] + g.m[a + k] * q.m[i + b];
            }
            columns[e].m[ik] += r.shear;
        }
    }

    PALPATE_DEVICE Real parameter_energy(const State& s, int k) const {
        return s.is_valid ? law().parameter_response(s.strain, k).energy : Real(0);
    }

    PALPATE_DEVICE Tensor3<Real> parameter_stress(const State& s, int k) const {
        if (!s.is_valid) return Tensor3<Real>{};
        const ParameterResponse<Real> r = law().parameter_response(s.strain, k);
        return mandel_to_piola(s, r.shear, r.pressure);
    }

private:
    PALPATE_DEVICE const Law& law() const { return static_cast<const Law&>(*this); }

    /// F^-T (shear 2 e + pressure I)
    PALPATE_DEVICE static Tensor3<Real> mandel_to_piola(const State& s, Real shear, Real pressure) {
        Tensor3<Real> mandel = scaled(s.strain.twice_deviator, shear);
        add_diagonal(mandel, pressure);
        return times(s.strain.inverse_transposed, mandel);
    }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "solver/base/tensor3.hpp"
#include "solver/materials/linear_law.hpp"

namespace palpate {

/// Laws whose stress knows no difference between the Piola stresses.
template <class Law>
constexpr bool is_small_strain = std::is_same_v<Law, LinearLaw<double>>;
template <class Law>
struct ViscousStep;
template <class Law>
constexpr bool is_small_strain<ViscousStep<Law>> = is_small_strain<Law>;
template <class Law>
constexpr bool is_viscous_step = false;
template <class Law>
constexpr bool is_viscous_step<ViscousStep<Law>> = true;

/// F^-T m; for small strains m itself.
template <class Law>
Tensor3<double> inverse_transposed_times(const Tensor3<double>& h, const Tensor3<double>& m) {
    if constexpr (is_small_strain<Law>) {
        return m;
    } else {
        Tensor3<double> f = h;
        add_diagonal(f, 1.0);
        return scaled(times(cofactors(f), m), 1 / (1 + determinant_change(h)));
    }
}

/// The second Piola stress F^-1 P of a law; for small strains P itself.
template <class Law>
Tensor3<double> second_piola(const Law& law, const Tensor3<double>& h) {
    const Tensor3<double> stress = law.stress(law.state(h));
    if constexpr (is_small_strain<Law>) {
        return stress;
    } else {
        Tensor3<double> f = h;
        add_diagonal(f, 1.0);
        return scaled(transposed_times(cofactors(f), stress), 1 / (1 + determinant_change(h)));
    }
}

/// One time step of quasi-linear viscoelasticity on top of a law, with the interface of a law. The
/// second Piola stress of the law times `factor`, plus what earlier steps left, is the derivative
/// of
///   W' = factor W + prestress : E
/// by the strain E, so a step is elastic (see time_steps.hpp).
template <class Law>
struct ViscousStep {
    using Number = double;
    struct State {
        typename Law::State elastic;
        Tensor3<double> h;
        bool is_valid;
    };

    Law law;
    double factor = 1;
    Tensor3<double> prestress{};  ///< symmetric, kPa

    State state(const Tensor3<double>& h) const {
        const auto elastic = law.state(h);
        return {elastic, h, elastic.is_valid};
    }
    double energy(const State& s) const {
        // prestress is symmetric: prestress : E = prestress : (H + H^T H / 2)
        double work = double_dot(prestress, s.h);
        if constexpr (!is_small_strain<Law>)
            work += 0.5 * double_dot(prestress, transposed_times(s.h, s.h));
        return factor * law.energy(s.elastic) + work;
    }
    Tensor3<double> stress(const State& s) const {
        return with_prestress(law.stress(s.elastic), s.h, 1.0);
    }
    Tensor3<double> tangent_apply(const State& s, const Tensor3<double>& dh) const {
        return with_prestress(law.tangent_apply(s.elastic, dh), dh, 0.0);
    }
    /// What earlier steps left is held.
    Tensor3<double> parameter_stress(const State& s, int k) const {
        return scaled(law.parameter_stress(s.elastic, k), factor);
    }

    /// Derivative of slope : S by H, S the second Piola stress of the law alone:
    ///   A[G] - G S,  G = F^-T slope
    Tensor3<double> elastic_stress_slope(const State& s, const Tensor3<double>& slope) const {
        const Tensor3<double> g = inverse_transposed_times<Law>(s.h, slope);
        const Tensor3<double> change = law.tangent_apply(s.elastic, g);
        if constexpr (is_small_strain<Law>) return change;
        return sum_of(1.0, change, -1.0, times(g, second_piola(law, s.h)));
    }
    /// For which `prestress` does the work that the direction D does on what it adds to P:
    /// the symmetric part of F^T D.
    Tensor3<double> prestress_slope(const State& s, const Tensor3<double>& direction) const {
        Tensor3<double> slope = direction;
        if constexpr (!is_small_strain<Law>)
            slope = sum_of(1.0, slope, 1.0, transposed_times(s.h, direction));
        Tensor3<double> sum = slope;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                sum.m[3 * i + j] = 0.5 * (slope.m[3 * i + j] + slope.m[3 * j + i]);
        return sum;
    }

private:
    /// factor p + (identity I + h) prestress, the last term without h for small strains.
    Tensor3<double> with_prestress(const Tensor3<double>& p, const Tensor3<double>& h,
                                   double identity) const {
        Tensor3<double> sum = sum_of(factor, p, identity, prestress);
        if constexpr (!is_small_strain<Law>) sum = sum_of(1.0, sum, 1.0, times(h, prestress));
        return sum;
    }
};

}  // namespace palpate

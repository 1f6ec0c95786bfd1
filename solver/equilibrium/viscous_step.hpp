// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <type_traits>
#include <utility>

#include "solver/base/tensor3.hpp"
#include "solver/materials/isochoric.hpp"
#include "solver/materials/linear_law.hpp"
#include "solver/model/solid_geometry.hpp"

namespace palpate {

template <class Relaxation>
struct ViscousStep;
template <class Relaxation>
inline constexpr bool is_small_strain<ViscousStep<Relaxation>> =
    is_small_strain<typename Relaxation::Whole>;
template <class Law>
inline constexpr bool is_viscous_step = false;
template <class Relaxation>
inline constexpr bool is_viscous_step<ViscousStep<Relaxation>> = true;

/// F^-1 p or, transposed, F^-T p; for small strains p itself.
template <bool small_strain, typename Real>
Tensor3<Real> inverse_times(const Tensor3<Real>& h, const Tensor3<Real>& p) {
    if constexpr (small_strain) {
        return p;
    } else {
        Tensor3<Real> f = h;
        add_diagonal(f, Real(1));
        return scaled(transposed_times(cofactors(f), p), 1 / (1 + determinant_change(h)));
    }
}
template <bool small_strain, typename Real>
Tensor3<Real> inverse_transposed_times(const Tensor3<Real>& h, const Tensor3<Real>& p) {
    if constexpr (small_strain) {
        return p;
    } else {
        Tensor3<Real> f = h;
        add_diagonal(f, Real(1));
        return scaled(times(cofactors(f), p), 1 / (1 + determinant_change(h)));
    }
}

/// The second Piola stress F^-1 P of a law; for small strains P itself.
template <class Law>
Tensor3<double> second_piola(const Law& law, const Tensor3<double>& h) {
    return inverse_times<is_small_strain<Law>>(h, law.stress(law.state(h)));
}

/// factor W: all of the law's stress relaxes.
template <class Law>
struct TotalRelaxation {
    using Whole = Law;
    using State = typename Law::State;

    Law law;
    double factor = 1;

    State state(const Tensor3<double>& h) const { return law.state(h); }
    double energy(const State& s) const { return factor * law.energy(s); }
    Tensor3<double> stress(const State& s) const { return scaled(law.stress(s), factor); }
    Tensor3<double> tangent_apply(const State& s, const Tensor3<double>& dh) const {
        return scaled(law.tangent_apply(s, dh), factor);
    }
    Tensor3<double> parameter_stress(const State& s, int k) const {
        return scaled(law.parameter_stress(s, k), factor);
    }

    /// The law of the stress that relaxes, and its state.
    const Law& part() const { return law; }
    const State& state_of_part(const State& s) const { return s; }
};

/// W + (factor - 1) W_iso: the stress of changes of shape relaxes, that of changes of volume not
/// (Holzapfel, Nonlinear Solid Mechanics, 2000, section 6.10).
template <class Law>
struct IsochoricRelaxation {
    using Whole = Law;
    using Scaled = decltype(isochorically_scaled(std::declval<const Law&>(), 1.0));
    using Part = decltype(isochoric_part(std::declval<const Law&>()));
    using State = typename Scaled::State;

    IsochoricRelaxation(const Law& law, double factor)
        : scaled_(isochorically_scaled(law, factor)), part_(isochoric_part(law)) {}

    State state(const Tensor3<double>& h) const { return scaled_.state(h); }
    double energy(const State& s) const { return scaled_.energy(s); }
    Tensor3<double> stress(const State& s) const { return scaled_.stress(s); }
    Tensor3<double> tangent_apply(const State& s, const Tensor3<double>& dh) const {
        return scaled_.tangent_apply(s, dh);
    }
    Tensor3<double> parameter_stress(const State& s, int k) const {
        return scaled_.parameter_stress(s, k);
    }

    /// As `TotalRelaxation` has them.
    const Part& part() const { return part_; }
    typename Part::State state_of_part(const State& s) const { return part_state(part_, s); }

private:
    Scaled scaled_;
    Part part_;
};

/// One time step of quasi-linear viscoelasticity on top of a law, with the interface of a law. The
/// second Piola stress S that relaxes, times a factor, the elastic rest, and what earlier steps
/// left are the derivative of
///   W' = (factor W, or W + (factor - 1) W_iso) + prestress : E
/// by the strain E, so a step is elastic (see time_steps.hpp). `Relaxation` is one of the two
/// above.
template <class Relaxation>
struct ViscousStep {
    using Number = typename Relaxation::Whole::Number;
    using Tensor = Tensor3<Number>;
    static constexpr bool small_strain = is_small_strain<typename Relaxation::Whole>;
    struct State {
        typename Relaxation::State relaxing;
        Tensor h;
        bool is_valid;
    };

    Relaxation relaxation;
    Tensor prestress{};  ///< symmetric, kPa

    /// What relaxes at one state, for any number of changes there.
    struct Relaxing {
        std::decay_t<decltype(std::declval<const Relaxation&>().state_of_part(
            std::declval<const typename Relaxation::State&>()))>
            part;
        Tensor stress;  ///< first Piola, kPa
    };
    Relaxing relaxing_at(const State& s) const {
        const auto part = relaxation.state_of_part(s.relaxing);
        return {part, relaxation.part().stress(part)};
    }

    State state(const Tensor& h) const {
        const auto relaxing = relaxation.state(h);
        return {relaxing, h, relaxing.is_valid};
    }
    Number energy(const State& s) const {
        // prestress is symmetric: prestress : E = prestress : (H + H^T H / 2)
        Number work = double_dot(prestress, s.h);
        if constexpr (!small_strain)
            work += 0.5 * double_dot(prestress, transposed_times(s.h, s.h));
        return relaxation.energy(s.relaxing) + work;
    }
    Tensor stress(const State& s) const {
        return with_prestress(relaxation.stress(s.relaxing), s.h, 1.0);
    }
    Tensor tangent_apply(const State& s, const Tensor& dh) const {
        return with_prestress(relaxation.tangent_apply(s.relaxing, dh), dh, 0.0);
    }
    void moduli(const State& s, const int* entries, int count,
                Tensor* columns) const requires HasModuli<Relaxation> {
        relaxation.moduli(s.relaxing, entries, count, columns);
        for (int e = 0; e < count; ++e) {
            // dH prestress, dH = e_i (outer) e_k
            const int ik = entries[e], i = ik / 3, k = ik % 3;
            for (int h = 0; h < count && !small_strain; ++h)
                if (entries[h] / 3 == i)
                    columns[e].m[entries[h]] += prestress.m[3 * k + entries[h] % 3];
        }
    }
    /// What earlier steps left is held.
    Tensor parameter_stress(const State& s, int k) const {
        return relaxation.parameter_stress(s.relaxing, k);
    }

    /// By a parameter: the first Piola stress of what relaxes.
    Tensor relaxing_parameter_stress(const Relaxing& r, int k) const {
        return relaxation.part().parameter_stress(r.part, k);
    }
    /// Derivative of slope : S by H:
    ///   A[G] - G S,  G = F^-T slope,  A the tangent of what relaxes
    Tensor relaxing_stress_slope(const State& s, const Relaxing& r, const Tensor& slope) const {
        const Tensor g = inverse_transposed_times<small_strain>(s.h, slope);
        const Tensor change = relaxation.part().tangent_apply(r.part, g);
        if constexpr (small_strain) return change;
        return sum_of(1.0, change, -1.0, times(g, inverse_times<small_strain>(s.h, r.stress)));
    }
    /// The change of S with H and with parameters of the law, per unit [parameters]:
    ///   dS = F^-1 (A[dH] + sum dP/dp_k dp_k - dH S)
    Tensor relaxing_stress_change(const State& s, const Relaxing& r, const Tensor& dh,
                                  std::span<const double> parameters) const {
        Tensor change = relaxation.part().tangent_apply(r.part, dh);
        for (std::size_t k = 0; k < parameters.size(); ++k)
            if (parameters[k] != 0)
                change = sum_of(1.0, change, parameters[k],
                                relaxing_parameter_stress(r, static_cast<int>(k)));
        if constexpr (!small_strain)
            change =
                sum_of(1.0, change, -1.0, times(dh, inverse_times<small_strain>(s.h, r.stress)));
        return inverse_times<small_strain>(s.h, change);
    }
    /// What a change of `prestress` adds to P: F dQ.
    Tensor prestress_stress(const State& s, const Tensor& change) const {
        if constexpr (small_strain) return change;
        return sum_of(1.0, change, 1.0, times(s.h, change));
    }
    /// For which `prestress` does the work that the direction D does on what it adds to P:
    /// the symmetric part of F^T D.
    Tensor prestress_slope(const State& s, const Tensor& direction) const {
        Tensor slope = direction;
        if constexpr (!small_strain)
            slope = sum_of(1.0, slope, 1.0, transposed_times(s.h, direction));
        return scaled(twice_symmetric_part(slope), 0.5);
    }

private:
    /// p + (identity I + h) prestress, the last term without h for small strains.
    Tensor with_prestress(const Tensor& p, const Tensor& h, double identity) const {
        Tensor sum = sum_of(1.0, p, identity, prestress);
        if constexpr (!small_strain) sum = sum_of(1.0, sum, 1.0, times(h, prestress));
        return sum;
    }
};

}  // namespace palpate

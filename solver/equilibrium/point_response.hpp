// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "solver/base/tensor3.hpp"

// What a law answers at one point once the formulation has had its say. Beside energy, stress and
// tangent:
//   gradient                H as the law has it
//   law_direction(dh)       the change of that H
//   pull_back(p)            the stress on the given H that does the work of p on the law's H:
//                           pull_back(p) : dh = p : law_direction(dh)
//   held_direction(p)       the direction D for which, at a given H, p does the work D : dP as the
//                           law's stress changes by dP (a parameter's, say); and, the same
//                           being symmetric, the change of the law's H that such a dP brings with
//                           it
namespace palpate {

/// The law as it is: in space, in plane strain and about an axis H is known completely.
template <class Law>
class FullResponse {
public:
    using State = typename Law::State;

    FullResponse(const Law& law, const Tensor3<double>& h)
        : law_(law), h_(h), state_(law.state(h)) {}

    bool is_valid() const { return state_.is_valid; }
    double energy() const { return law_.energy(state_); }
    Tensor3<double> stress() const { return law_.stress(state_); }
    Tensor3<double> tangent_apply(const Tensor3<double>& dh) const {
        return law_.tangent_apply(state_, dh);
    }
    Tensor3<double> law_direction(const Tensor3<double>& dh) const { return dh; }
    Tensor3<double> pull_back(const Tensor3<double>& p) const { return p; }
    Tensor3<double> held_direction(const Tensor3<double>&) const { return {}; }

    const Law& law() const { return law_; }
    const State& state() const { return state_; }
    const Tensor3<double>& gradient() const { return h_; }

private:
    Law law_;
    Tensor3<double> h_;
    State state_;
};

/// Plane stress: H_zz is such that P_zz = 0, found by Newton, and its change is condensed out of
/// the tangent: dP = A dH - A e_zz (A_zz,zz)^-1 (A dH)_zz.
template <class Law>
class PlaneStressResponse {
public:
    using State = typename Law::State;

    PlaneStressResponse(const Law& law, const Tensor3<double>& in_plane)
        : law_(law), h_(in_plane), state_(law.state(in_plane)) {
        constexpr int most_steps = 50;
        constexpr double small_step = 1e-14;
        for (int step = 0; step < most_steps; ++step) {
            if (!state_.is_valid) return;
            across_ = law_.tangent_apply(state_, unit_across());
            // Where P_zz bends down with F_zz, F_zz P_zz = 0 is solved instead.
            const double stress = law_.stress(state_).m[8];
            double slope = across_.m[8];
            if (!(slope > 0)) slope += stress / (1 + h_.m[8]);
            if (!(slope > 0)) break;
            double change = -stress / slope;
            State next = with_across(change);
            while (!next.is_valid && std::abs(change) > small_step) {
                change *= 0.5;
                next = with_across(change);
            }
            h_.m[8] += change;
            state_ = next;
            if (std::abs(change) <= small_step * (1 + std::abs(h_.m[8]))) {
                across_ = law_.tangent_apply(state_, unit_across());
                is_solved_ = across_.m[8] > 0;
                return;
            }
        }
    }

    bool is_valid() const { return state_.is_valid && is_solved_; }
    double energy() const { return law_.energy(state_); }
    Tensor3<double> stress() const { return law_.stress(state_); }
    Tensor3<double> tangent_apply(const Tensor3<double>& dh) const {
        return relaxed(law_.tangent_apply(state_, dh));
    }
    Tensor3<double> law_direction(Tensor3<double> dh) const {
        dh.m[8] -= law_.tangent_apply(state_, dh).m[8] / across_.m[8];
        return dh;
    }
    Tensor3<double> pull_back(const Tensor3<double>& p) const { return relaxed(p); }
    Tensor3<double> held_direction(const Tensor3<double>& p) const {
        return scaled(unit_across(), -p.m[8] / across_.m[8]);
    }

    const Law& law() const { return law_; }
    const State& state() const { return state_; }
    /// H_zz solved for.
    const Tensor3<double>& gradient() const { return h_; }

private:
    /// A change of stress at a held H_zz, once H_zz has followed.
    Tensor3<double> relaxed(Tensor3<double> dp) const {
        const double change = -dp.m[8] / across_.m[8];
        for (int i = 0; i < 9; ++i) dp.m[i] += change * across_.m[i];
        return dp;
    }
    static Tensor3<double> unit_across() {
        Tensor3<double> unit{};
        unit.m[8] = 1;
        return unit;
    }
    State with_across(double change) const {
        Tensor3<double> h = h_;
        h.m[8] += change;
        return law_.state(h);
    }

    Law law_;
    Tensor3<double> h_;
    State state_;
    Tensor3<double> across_{};
    bool is_solved_ = false;
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <math.h>

#include <cstdint>

#include "solver/base/tensor3.hpp"
#include "solver/base/types.hpp"
#include "solver/elements/element.hpp"

// Energy, forces and stiffness of one element of any type and law in plain arrays and any
// precision, for the element loops of back ends; the twin of kernels/solid_element.cl. Every point
// has the volume change that the displacement gives it there. Vectors are [3 num_nodes, columns],
// column index fastest.
namespace palpate {

/// How the geometry of an element's points lies in memory (`SolidTables`).
struct SolidLayout {
    int num_nodes = 0;
    int num_points = 0;
    bool has_hoop = false;  ///< axisymmetry

    /// gradient [num_nodes, 3], volume, and [num_nodes] hoop if there is one: see `PointGeometry`.
    PALPATE_DEVICE int reals_per_point() const { return num_nodes * (has_hoop ? 4 : 3) + 1; }
};

template <typename Real>
struct SolidElement {
    const Index* nodes;  ///< [num_nodes]
    const Real* points;  ///< [num_points, reals_per_point]
    SolidLayout layout;

    PALPATE_DEVICE const Real* gradient(int q) const {
        return points + q * layout.reals_per_point();
    }
    PALPATE_DEVICE Real volume(int q) const { return gradient(q)[3 * layout.num_nodes]; }
    PALPATE_DEVICE Real hoop(int q, int a) const {
        return layout.has_hoop ? gradient(q)[3 * layout.num_nodes + 1 + a] : Real(0);
    }
};

/// H at a point of one column of u. Gradients add up to zero, so the element's own translation is
/// taken off first: in fp32 it would cost digits.
template <typename Real>
PALPATE_DEVICE Tensor3<Real> displacement_gradient(const SolidElement<Real>& element, int q,
                                                   const Real* u, std::int64_t columns = 1) {
    Tensor3<Real> h{};
    const Real* const gradient = element.gradient(q);
    const Real* const origin = u + 3 * element.nodes[0] * columns;
    for (int a = 1; a < element.layout.num_nodes; ++a) {
        const Real* const here = u + 3 * element.nodes[a] * columns;
        for (int i = 0; i < 3; ++i) {
            const Real difference = here[i * columns] - origin[i * columns];
            for (int j = 0; j < 3; ++j) h.m[3 * i + j] += difference * gradient[3 * a + j];
        }
    }
    if (element.layout.has_hoop)
        for (int a = 0; a < element.layout.num_nodes; ++a)
            h.m[8] += u[3 * element.nodes[a] * columns] * element.hoop(q, a);
    return h;
}

/// force[a, i] += volume P : dH/du_ai for all nodes a of the element, [num_nodes, 3].
template <typename Real>
PALPATE_DEVICE void add_force(const SolidElement<Real>& element, int q, const Tensor3<Real>& stress,
                              Real* force) {
    const Real* const gradient = element.gradient(q);
    const Real volume = element.volume(q);
    for (int a = 0; a < element.layout.num_nodes; ++a) {
        for (int i = 0; i < 3; ++i)
            force[3 * a + i] += volume * (stress.m[3 * i] * gradient[3 * a] +
                                          stress.m[3 * i + 1] * gradient[3 * a + 1] +
                                          stress.m[3 * i + 2] * gradient[3 * a + 2]);
        force[3 * a] += volume * stress.m[8] * element.hoop(q, a);
    }
}

/// Writes force [num_nodes, 3] mN and returns the energy, mN mm: infinite, with no force, where a
/// point is not valid.
template <class Law, typename Real>
PALPATE_DEVICE Real element_force(const Law& law, const SolidElement<Real>& element, const Real* u,
                                  Real* force) {
    const int size = 3 * element.layout.num_nodes;
    for (int k = 0; k < size; ++k) force[k] = 0;
    Real energy = 0;
    for (int q = 0; q < element.layout.num_points; ++q) {
        const auto state = law.state(displacement_gradient(element, q, u));
        if (!state.is_valid) {
            for (int k = 0; k < size; ++k) force[k] = 0;
            return Real(HUGE_VAL);
        }
        energy += element.volume(q) * law.energy(state);
        add_force(element, q, law.stress(state), force);
    }
    return energy;
}

/// Adds to blocks [num_nodes, num_nodes, 3, 3] what a point with the moduli dP = sum over c of
/// moduli[c] dH_c gives to the stiffness.
template <typename Real>
PALPATE_DEVICE void add_stiffness(const SolidElement<Real>& element, int q,
                                  const Tensor3<Real>* moduli, Real* blocks) {
    const Real* const gradient = element.gradient(q);
    const Real volume = element.volume(q);
    const int n = element.layout.num_nodes;
    for (int b = 0; b < n; ++b)
        for (int j = 0; j < 3; ++j) {
            Tensor3<Real> stress;  // dP by u_bj
            for (int r = 0; r < 9; ++r)
                stress.m[r] = volume * (moduli[3 * j].m[r] * gradient[3 * b] +
                                        moduli[3 * j + 1].m[r] * gradient[3 * b + 1] +
                                        moduli[3 * j + 2].m[r] * gradient[3 * b + 2]);
            if (j == 0)
                for (int r = 0; r < 9; ++r)
                    stress.m[r] += volume * moduli[8].m[r] * element.hoop(q, b);
            for (int a = 0; a < n; ++a) {
                Real* const column = blocks + 9 * (a * n + b) + j;
                for (int i = 0; i < 3; ++i)
                    column[3 * i] += stress.m[3 * i] * gradient[3 * a] +
                                     stress.m[3 * i + 1] * gradient[3 * a + 1] +
                                     stress.m[3 * i + 2] * gradient[3 * a + 2];
                column[0] += stress.m[8] * element.hoop(q, a);
            }
        }
}

/// The moduli of a state: moduli[c] is dP by entry c of H.
template <class Law, typename Real>
PALPATE_DEVICE void moduli_of(const Law& law, const typename Law::State& state,
                              Tensor3<Real>* moduli) {
    for (int c = 0; c < 9; ++c) {
        Tensor3<Real> unit{};
        unit.m[c] = 1;
        moduli[c] = law.tangent_apply(state, unit);
    }
}

/// Writes blocks [num_nodes, num_nodes, 3, 3], mN/mm. Points that are not valid add nothing.
template <class Law, typename Real>
PALPATE_DEVICE void element_tangent(const Law& law, const SolidElement<Real>& element,
                                    const Real* u, Real* blocks) {
    const int n = element.layout.num_nodes;
    for (int k = 0; k < 9 * n * n; ++k) blocks[k] = 0;
    Tensor3<Real> moduli[9];
    for (int q = 0; q < element.layout.num_points; ++q) {
        const auto state = law.state(displacement_gradient(element, q, u));
        if (!state.is_valid) continue;
        moduli_of(law, state, moduli);
        add_stiffness(element, q, moduli, blocks);
    }
}

/// Writes forces [num_nodes, 3, columns] of K(u) x for all columns of x.
template <class Law, typename Real>
PALPATE_DEVICE void element_product(const Law& law, const SolidElement<Real>& element,
                                    const Real* u, const Real* x, std::int64_t columns,
                                    Real* forces) {
    typename Law::State states[most_element_points];
    for (int q = 0; q < element.layout.num_points; ++q)
        states[q] = law.state(displacement_gradient(element, q, u));
    for (std::int64_t c = 0; c < columns; ++c) {
        Real force[3 * most_element_nodes] = {};
        for (int q = 0; q < element.layout.num_points; ++q)
            if (states[q].is_valid)
                add_force(
                    element, q,
                    law.tangent_apply(states[q], displacement_gradient(element, q, x + c, columns)),
                    force);
        for (int k = 0; k < 3 * element.layout.num_nodes; ++k) forces[k * columns + c] = force[k];
    }
}

/// lambda . df/dp for parameter p number k of the law, mN mm per unit of the parameter; nothing
/// where a point is not valid.
template <class Law, typename Real>
PALPATE_DEVICE Real element_parameter_product(const Law& law, const SolidElement<Real>& element,
                                              const Real* u, const Real* lambda, int k) {
    Real sum = 0;
    for (int q = 0; q < element.layout.num_points; ++q) {
        const auto state = law.state(displacement_gradient(element, q, u));
        if (!state.is_valid) return 0;
        sum += element.volume(q) * double_dot(law.parameter_stress(state, k),
                                              displacement_gradient(element, q, lambda));
    }
    return sum;
}

}  // namespace palpate

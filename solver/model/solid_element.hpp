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

/// One point of an element: see `PointGeometry`.
template <typename Real>
struct SolidPoint {
    int num_nodes;
    const Real* gradient;  ///< [num_nodes, 3]
    const Real* hoop;      ///< [num_nodes], or null
    Real volume;
};

template <typename Real>
struct SolidElement {
    const Index* nodes;  ///< [num_nodes]
    const Real* points;  ///< [num_points, reals_per_point]
    SolidLayout layout;

    PALPATE_DEVICE SolidPoint<Real> point(int q) const {
        const Real* const gradient = points + q * layout.reals_per_point();
        const Real* const volume = gradient + 3 * layout.num_nodes;
        return {layout.num_nodes, gradient, layout.has_hoop ? volume + 1 : nullptr, *volume};
    }
};

/// H at a point of one column of u. Gradients add up to zero, so the element's own translation is
/// taken off first: in fp32 it would cost digits.
///   nodes  [num_nodes] of the element
template <typename Real>
PALPATE_DEVICE Tensor3<Real> displacement_gradient(const SolidPoint<Real>& point,
                                                   const Index* nodes, const Real* u,
                                                   std::int64_t columns = 1) {
    Tensor3<Real> h{};
    const Real* const origin = u + 3 * nodes[0] * columns;
    for (int a = 1; a < point.num_nodes; ++a) {
        const Real* const here = u + 3 * nodes[a] * columns;
        for (int i = 0; i < 3; ++i) {
            const Real difference = here[i * columns] - origin[i * columns];
            for (int j = 0; j < 3; ++j) h.m[3 * i + j] += difference * point.gradient[3 * a + j];
        }
    }
    if (point.hoop)
        for (int a = 0; a < point.num_nodes; ++a)
            h.m[8] += u[3 * nodes[a] * columns] * point.hoop[a];
    return h;
}

/// force[a, i] += volume P : dH/du_ai for all nodes a of the element, [num_nodes, 3].
template <typename Real>
PALPATE_DEVICE void add_force(const SolidPoint<Real>& point, const Tensor3<Real>& stress,
                              Real* force) {
    const Real* const gradient = point.gradient;
    for (int a = 0; a < point.num_nodes; ++a) {
        for (int i = 0; i < 3; ++i)
            force[3 * a + i] += point.volume * (stress.m[3 * i] * gradient[3 * a] +
                                                stress.m[3 * i + 1] * gradient[3 * a + 1] +
                                                stress.m[3 * i + 2] * gradient[3 * a + 2]);
        if (point.hoop) force[3 * a] += point.volume * stress.m[8] * point.hoop[a];
    }
}

/// Adds to blocks [num_nodes, num_nodes, 3, 3] what a point gives to the stiffness.
///   moduli  [9] dP by each entry of H
template <typename Real>
PALPATE_DEVICE void add_stiffness(const SolidPoint<Real>& point, const Tensor3<Real>* moduli,
                                  Real* blocks) {
    const Real* const gradient = point.gradient;
    const int n = point.num_nodes;
    for (int b = 0; b < n; ++b)
        for (int j = 0; j < 3; ++j) {
            Tensor3<Real> stress;  // dP by u_bj
            for (int r = 0; r < 9; ++r)
                stress.m[r] = point.volume * (moduli[3 * j].m[r] * gradient[3 * b] +
                                              moduli[3 * j + 1].m[r] * gradient[3 * b + 1] +
                                              moduli[3 * j + 2].m[r] * gradient[3 * b + 2]);
            if (point.hoop && j == 0)
                for (int r = 0; r < 9; ++r)
                    stress.m[r] += point.volume * moduli[8].m[r] * point.hoop[b];
            for (int a = 0; a < n; ++a) {
                Real* const column = blocks + 9 * (a * n + b) + j;
                for (int i = 0; i < 3; ++i)
                    column[3 * i] += stress.m[3 * i] * gradient[3 * a] +
                                     stress.m[3 * i + 1] * gradient[3 * a + 1] +
                                     stress.m[3 * i + 2] * gradient[3 * a + 2];
                if (point.hoop) column[0] += stress.m[8] * point.hoop[a];
            }
        }
}

/// Writes moduli [9], dP by each entry of H. `tangent_apply`: dP of a dH.
template <typename Real, class TangentApply>
PALPATE_DEVICE void moduli_of(const TangentApply& tangent_apply, Tensor3<Real>* moduli) {
    for (int c = 0; c < 9; ++c) {
        Tensor3<Real> unit{};
        unit.m[c] = 1;
        moduli[c] = tangent_apply(unit);
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
        const SolidPoint<Real> point = element.point(q);
        const auto state = law.state(displacement_gradient(point, element.nodes, u));
        if (!state.is_valid) {
            for (int k = 0; k < size; ++k) force[k] = 0;
            return Real(HUGE_VAL);
        }
        energy += point.volume * law.energy(state);
        add_force(point, law.stress(state), force);
    }
    return energy;
}

/// Writes blocks [num_nodes, num_nodes, 3, 3], mN/mm; zeros where a point is not valid.
template <class Law, typename Real>
PALPATE_DEVICE void element_tangent(const Law& law, const SolidElement<Real>& element,
                                    const Real* u, Real* blocks) {
    const int size = 9 * element.layout.num_nodes * element.layout.num_nodes;
    for (int k = 0; k < size; ++k) blocks[k] = 0;
    Tensor3<Real> moduli[9];
    for (int q = 0; q < element.layout.num_points; ++q) {
        const SolidPoint<Real> point = element.point(q);
        const auto state = law.state(displacement_gradient(point, element.nodes, u));
        if (!state.is_valid) {
            for (int k = 0; k < size; ++k) blocks[k] = 0;
            return;
        }
        moduli_of([&](const Tensor3<Real>& dh) { return law.tangent_apply(state, dh); }, moduli);
        add_stiffness(point, moduli, blocks);
    }
}

/// Writes forces [num_nodes, 3, columns] of K(u) x for all columns of x; zeros where a point is not
/// valid.
template <class Law, typename Real>
PALPATE_DEVICE void element_product(const Law& law, const SolidElement<Real>& element,
                                    const Real* u, const Real* x, std::int64_t columns,
                                    Real* forces) {
    typename Law::State states[most_element_points];
    bool is_valid = true;
    for (int q = 0; q < element.layout.num_points; ++q) {
        states[q] = law.state(displacement_gradient(element.point(q), element.nodes, u));
        is_valid = is_valid && states[q].is_valid;
    }
    for (std::int64_t c = 0; c < columns; ++c) {
        Real force[3 * most_element_nodes] = {};
        for (int q = 0; q < element.layout.num_points && is_valid; ++q) {
            const SolidPoint<Real> point = element.point(q);
            const auto dh = displacement_gradient(point, element.nodes, x + c, columns);
            add_force(point, law.tangent_apply(states[q], dh), force);
        }
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
        const SolidPoint<Real> point = element.point(q);
        const auto state = law.state(displacement_gradient(point, element.nodes, u));
        if (!state.is_valid) return 0;
        sum += point.volume * double_dot(law.parameter_stress(state, k),
                                         displacement_gradient(point, element.nodes, lambda));
    }
    return sum;
}

}  // namespace palpate

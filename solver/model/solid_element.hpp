// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <math.h>

#include <cstdint>

#include "solver/model/mean_volume.hpp"
#include "solver/model/solid_geometry.hpp"

// Energy, forces and stiffness of one element of any type, law and treatment of the volume, for the
// element loops of back ends; the twin of kernels/solid_*.cl. Each function first asks whether the
// points share their volume change (mean_volume.hpp); else every point has the one that the
// displacement gives it there.
namespace palpate {

template <class Law, typename Real>
using MeanVolumeOf = MeanVolume<Law, SameLaw<Law>, SolidElement<Real>>;

/// Writes force [num_nodes, 3] mN and returns the energy, mN mm: infinite, with no force, where a
/// point is not valid.
template <class Law, typename Real>
PALPATE_DEVICE Real element_force(const Law& law, const SolidElement<Real>& element, const Real* u,
                                  Real* force) {
    const int size = 3 * element.layout.num_nodes;
    for (int k = 0; k < size; ++k) force[k] = 0;
    if (element.layout.has_mean_volume) {
        const SameLaw<Law> law_at{law};
        const MeanVolumeOf<Law, Real> response(law_at, element, u);
        if (!response.is_valid()) return Real(HUGE_VAL);
        TensorsAtPoints<Real> stress;
        response.stress(stress);
        for (int q = 0; q < element.num_points(); ++q)
            add_force(element.point(q), stress[q], force);
        return response.energy();
    }
    Real energy = 0;
    for (int q = 0; q < element.num_points(); ++q) {
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
    if (element.layout.has_mean_volume) {
        const SameLaw<Law> law_at{law};
        const MeanVolumeOf<Law, Real> response(law_at, element, u);
        if (response.is_valid()) response.add_stiffness(blocks);
        return;
    }
    Tensor3<Real> moduli[9];
    for (int q = 0; q < element.num_points(); ++q) {
        const SolidPoint<Real> point = element.point(q);
        const auto state = law.state(displacement_gradient(point, element.nodes, u));
        if (!state.is_valid) {
            for (int k = 0; k < size; ++k) blocks[k] = 0;
            return;
        }
        moduli_of(law, state, moduli);
        add_stiffness(point, moduli, blocks);
    }
}

/// Writes forces [num_nodes, 3, columns] for all columns of x: of `change_of`(dH, dP), dP of the
/// points by dH of the points.
template <typename Real, class ChangeOf>
PALPATE_DEVICE void write_product(const SolidElement<Real>& element, const Real* x,
                                  std::int64_t columns, Real* forces, const ChangeOf& change_of) {
    TensorsAtPoints<Real> dh, dp;
    for (std::int64_t c = 0; c < columns; ++c) {
        for (int q = 0; q < element.num_points(); ++q)
            dh[q] = element.displacement_gradient_at(q, x + c, columns);
        change_of(dh, dp);
        Real force[3 * most_element_nodes] = {};
        for (int q = 0; q < element.num_points(); ++q) add_force(element.point(q), dp[q], force);
        for (int k = 0; k < 3 * element.layout.num_nodes; ++k) forces[k * columns + c] = force[k];
    }
}

/// Writes forces [num_nodes, 3, columns] of K(u) x for all columns of x; zeros where a point is not
/// valid.
template <class Law, typename Real>
PALPATE_DEVICE void element_product(const Law& law, const SolidElement<Real>& element,
                                    const Real* u, const Real* x, std::int64_t columns,
                                    Real* forces) {
    using Tensors = TensorsAtPoints<Real>;
    bool is_valid = true;
    if (element.layout.has_mean_volume) {
        const SameLaw<Law> law_at{law};
        const MeanVolumeOf<Law, Real> response(law_at, element, u);
        is_valid = response.is_valid();
        if (is_valid)
            write_product(element, x, columns, forces,
                          [&](const Tensors& dh, Tensors& dp) { response.tangent_apply(dh, dp); });
    } else {
        typename Law::State states[most_element_points];
        for (int q = 0; q < element.num_points(); ++q) {
            states[q] = law.state(element.displacement_gradient_at(q, u));
            is_valid = is_valid && states[q].is_valid;
        }
        if (is_valid)
            write_product(element, x, columns, forces, [&](const Tensors& dh, Tensors& dp) {
                for (int q = 0; q < element.num_points(); ++q)
                    dp[q] = law.tangent_apply(states[q], dh[q]);
            });
    }
    for (std::int64_t k = 0; k < 3 * element.layout.num_nodes * columns && !is_valid; ++k)
        forces[k] = 0;
}

/// lambda . df/dp for parameter p number k of the law, mN mm per unit of the parameter; nothing
/// where a point is not valid.
template <class Law, typename Real>
PALPATE_DEVICE Real element_parameter_product(const Law& law, const SolidElement<Real>& element,
                                              const Real* u, const Real* lambda, int k) {
    Real sum = 0;
    if (element.layout.has_mean_volume) {
        const SameLaw<Law> law_at{law};
        const MeanVolumeOf<Law, Real> response(law_at, element, u);
        if (!response.is_valid()) return 0;
        TensorsAtPoints<Real> direction;
        for (int q = 0; q < element.num_points(); ++q)
            direction[q] = element.displacement_gradient_at(q, lambda);
        response.law_directions(direction, direction);
        for (int q = 0; q < element.num_points(); ++q)
            sum += element.point(q).volume *
                   double_dot(law.parameter_stress(response.state(q), k), direction[q]);
        return sum;
    }
    for (int q = 0; q < element.num_points(); ++q) {
        const SolidPoint<Real> point = element.point(q);
        const auto state = law.state(displacement_gradient(point, element.nodes, u));
        if (!state.is_valid) return 0;
        sum += point.volume * double_dot(law.parameter_stress(state, k),
                                         displacement_gradient(point, element.nodes, lambda));
    }
    return sum;
}

}  // namespace palpate

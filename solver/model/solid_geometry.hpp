// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "solver/base/tensor3.hpp"
#include "solver/base/types.hpp"
#include "solver/elements/element.hpp"

// One element of any type in plain arrays and any precision, and what its points add to forces and
// stiffness. Vectors are [3 num_nodes, columns], column index fastest.
namespace palpate {

/// How the geometry of an element's points lies in memory (`SolidTables`).
struct SolidLayout {
    int num_nodes = 0;
    int num_points = 0;
    bool has_hoop = false;         ///< axisymmetry
    bool has_mean_volume = false;  ///< `VolumeTreatment::element_mean`

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
    PALPATE_DEVICE int num_points() const { return layout.num_points; }
    /// H at point q of one column of u.
    PALPATE_DEVICE Tensor3<Real> displacement_gradient_at(int q, const Real* u,
                                                          std::int64_t columns = 1) const {
        return displacement_gradient(point(q), nodes, u, columns);
    }
};

/// One tensor per point of an element.
template <typename Real>
struct TensorsAtPoints {
    Tensor3<Real> at[most_element_points];

    PALPATE_DEVICE Tensor3<Real>& operator[](std::size_t q) { return at[q]; }
    PALPATE_DEVICE const Tensor3<Real>& operator[](std::size_t q) const { return at[q]; }
};

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

template <class Law>
concept HasModuli = requires(const Law law, const typename Law::State state, const int* entries,
                             Tensor3<typename Law::Number>* columns) {
    law.moduli(state, entries, 1, columns);
};

/// Column e: dP by entry entries[e] of H, at least of those entries [count] of P.
template <class Law>
PALPATE_DEVICE void moduli_of(const Law& law, const typename Law::State& state, const int* entries,
                              int count, Tensor3<typename Law::Number>* columns) {
    if constexpr (HasModuli<Law>) {
        law.moduli(state, entries, count, columns);
    } else {
        for (int e = 0; e < count; ++e) {
            Tensor3<typename Law::Number> unit{};
            unit.m[entries[e]] = 1;
            columns[e] = law.tangent_apply(state, unit);
        }
    }
}
/// All nine.
template <class Law>
PALPATE_DEVICE void moduli_of(const Law& law, const typename Law::State& state,
                              Tensor3<typename Law::Number>* columns) {
    const int entries[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    moduli_of(law, state, entries, 9, columns);
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

}  // namespace palpate

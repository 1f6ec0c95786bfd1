// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Kokkos_Core.hpp>

#include "solver/base/types.hpp"

// The linear tetrahedron of solver/elements/tet4.hpp in plain arrays, for kernels.
namespace palpate {

/// Gradients of the four shape functions, 1/mm, and the volume, mm^3.
template <typename Real>
struct DeviceTet4 {
    Real gradient[4][3];
    Real volume;
};

/// From edges e[a] = p_{a+1} - p_0 (mm): the gradients of N_1 to N_3 are the rows of the inverse of
/// [e0, e1, e2], that is e1 x e2 / det and so on.
template <typename Real>
KOKKOS_INLINE_FUNCTION DeviceTet4<Real> tet4_of_edges(const Real (&e)[3][3]) {
    DeviceTet4<Real> tet;
    for (int a = 0; a < 3; ++a) {
        const Real* const f = e[(a + 1) % 3];
        const Real* const g = e[(a + 2) % 3];
        for (int i = 0; i < 3; ++i)
            tet.gradient[a + 1][i] =
                f[(i + 1) % 3] * g[(i + 2) % 3] - f[(i + 2) % 3] * g[(i + 1) % 3];
    }
    const Real determinant =
        e[0][0] * tet.gradient[1][0] + e[0][1] * tet.gradient[1][1] + e[0][2] * tet.gradient[1][2];
    for (int i = 0; i < 3; ++i) {
        for (int a = 1; a < 4; ++a) tet.gradient[a][i] /= determinant;
        tet.gradient[0][i] = -(tet.gradient[1][i] + tet.gradient[2][i] + tet.gradient[3][i]);
    }
    tet.volume = determinant / 6;
    return tet;
}

/// block = V (lambda ga gb^T + mu gb ga^T + mu (ga . gb) I), row by row, mN/mm.
template <typename Real>
KOKKOS_INLINE_FUNCTION void tet4_stiffness_block(const DeviceTet4<Real>& tet, int a, int b,
                                                 Real lambda, Real mu, Real (&block)[9]) {
    const Real* const ga = tet.gradient[a];
    const Real* const gb = tet.gradient[b];
    const Real l = tet.volume * lambda, m = tet.volume * mu;
    const Real dot = m * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            block[3 * i + j] = l * ga[i] * gb[j] + m * gb[i] * ga[j] + (i == j ? dot : Real(0));
}

/// Geometry from node positions. Edges are differences in fp64, so that far from the origin single
/// precision loses nothing.
template <typename Real>
struct RecomputedGeometry {
    const double* nodes;  ///< [num_nodes, 3], mm
    const Index* tets;    ///< [num_tets, 4]

    KOKKOS_INLINE_FUNCTION DeviceTet4<Real> operator()(std::int64_t t) const {
        const double* const p0 = nodes + 3 * static_cast<std::int64_t>(tets[4 * t]);
        Real edges[3][3];
        for (int a = 0; a < 3; ++a) {
            const double* const p = nodes + 3 * static_cast<std::int64_t>(tets[4 * t + a + 1]);
            for (int i = 0; i < 3; ++i) edges[a][i] = static_cast<Real>(p[i] - p0[i]);
        }
        return tet4_of_edges(edges);
    }
};

/// Geometry as `store` left it.
template <typename Real>
struct StoredGeometry {
    static constexpr int numbers_per_tet = 13;

    const Real* numbers;  ///< [num_tets, 4 gradients and the volume]

    KOKKOS_INLINE_FUNCTION DeviceTet4<Real> operator()(std::int64_t t) const {
        const Real* const from = numbers + numbers_per_tet * t;
        DeviceTet4<Real> tet;
        for (int a = 0; a < 4; ++a)
            for (int i = 0; i < 3; ++i) tet.gradient[a][i] = from[3 * a + i];
        tet.volume = from[12];
        return tet;
    }
};

template <typename Real>
struct StoreGeometry {
    RecomputedGeometry<double> geometry;
    Real* numbers;  ///< [num_tets, 4 gradients and the volume]

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t t) const {
        const DeviceTet4<double> tet = geometry(t);
        Real* const to = numbers + StoredGeometry<Real>::numbers_per_tet * t;
        for (int a = 0; a < 4; ++a)
            for (int i = 0; i < 3; ++i) to[3 * a + i] = static_cast<Real>(tet.gradient[a][i]);
        to[12] = static_cast<Real>(tet.volume);
    }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backends/kokkos/operator_rows.hpp"

namespace palpate {

/// sums_c += lambda_c . K_r x_c of a list of tetrahedra at the given Lame parameters:
///   V (lame_lambda tr L tr X + 2 lame_mu L : X) with the symmetric gradients L, X of both.
template <typename Real>
struct ElementWorkBody {
    static constexpr Index part_length = 64;

    RecomputedGeometry<Real> geometry;
    const Index* list;  ///< the items: numbers of tetrahedra
    Real lame_lambda;
    Real lame_mu;
    const Real* lambda;
    const Real* x;
    Index columns;

    template <int width>
    KOKKOS_INLINE_FUNCTION void run(Index first, Index last, Index column,
                                    Lanes<double, width>& sums) const {
        for (Index item = first; item < last; ++item) {
            const std::int64_t t = list[item];
            const DeviceTet4<Real> tet = geometry(t);
            Lanes<Real, width> of_lambda[6], of_x[6];
            strain(t, tet, lambda + column, of_lambda);
            strain(t, tet, x + column, of_x);
            add_work(tet.volume, of_lambda, of_x, sums);
        }
    }

    /// xx, yy, zz, xy, yz, zx of (grad u + grad u^T) / 2
    template <int width>
    KOKKOS_INLINE_FUNCTION void strain(std::int64_t t, const DeviceTet4<Real>& tet, const Real* u,
                                       Lanes<Real, width> (&e)[6]) const {
        for (int i = 0; i < 6; ++i) e[i].clear();
        for (int a = 0; a < 4; ++a) {
            const std::int64_t row = 3 * static_cast<std::int64_t>(geometry.tets[4 * t + a]);
            Lanes<Real, width> ua[3];
            for (int i = 0; i < 3; ++i) ua[i].load(u + (row + i) * columns);
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3;
                e[i].add_product(tet.gradient[a][i], ua[i]);
                e[3 + i].add_product(Real(0.5) * tet.gradient[a][j], ua[i]);
                e[3 + i].add_product(Real(0.5) * tet.gradient[a][i], ua[j]);
            }
        }
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void add_work(Real volume, Lanes<Real, width> (&l)[6],
                                         const Lanes<Real, width> (&m)[6],
                                         Lanes<double, width>& sums) const {
        Lanes<Real, width> trace;
        trace.clear();
        for (int i = 0; i < 3; ++i) trace.add(m[i]);
        for (int i = 0; i < 3; ++i) {
            Lanes<Real, width> stress = m[i];
            stress.scale(2 * lame_mu);
            stress.add_product(lame_lambda, trace);
            l[i].scale(volume);
            sums.add_wide_product(l[i], stress);
            l[3 + i].scale(4 * lame_mu * volume);
            sums.add_wide_product(l[3 + i], m[3 + i]);
        }
    }
};

/// Assembles the constrained K: block row by block row, each contribution to the block of its
/// column, which is found in the ascending list.
template <typename Real>
struct AssembleRows {
    DeviceMesh mesh;
    RecomputedGeometry<double> geometry;
    const Index* offsets;
    const Index* items;
    Real* blocks;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t n) const {
        for (std::int64_t at = 9 * static_cast<std::int64_t>(offsets[n]);
             at < 9 * static_cast<std::int64_t>(offsets[n + 1]); ++at)
            blocks[at] = 0;
        for (Index k = mesh.corner_offsets[n]; k < mesh.corner_offsets[n + 1]; ++k) {
            const Index corner = mesh.corners[k];
            const std::int64_t t = corner / 4;
            const DeviceTet4<double> tet = geometry(t);
            const double* const lame = mesh.lame + 2 * mesh.region[t];
            for (int b = 0; b < 4; ++b) {
                double block[9];
                tet4_stiffness_block(tet, corner % 4, b, lame[0], lame[1], block);
                add(n, mesh.tets[4 * t + b], block);
            }
        }
        for (int i = 0; i < 3; ++i)
            if (mesh.prescribed[3 * n + i]) blocks[9 * find(n, n) + 4 * i] = 1;
    }

    KOKKOS_INLINE_FUNCTION std::int64_t find(std::int64_t n, std::int64_t m) const {
        std::int64_t k = offsets[n];
        while (items[k] != m) ++k;
        return k;
    }

    KOKKOS_INLINE_FUNCTION void add(std::int64_t n, std::int64_t m,
                                    const double (&block)[9]) const {
        Real* const to = blocks + 9 * find(n, m);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (!mesh.prescribed[3 * n + i] && !mesh.prescribed[3 * m + j])
                    to[3 * i + j] += static_cast<Real>(block[3 * i + j]);
    }
};

/// Inverted 3x3 diagonal blocks of the constrained K; a dof without stiffness counts as 1.
template <typename Real>
struct InvertDiagonal {
    DeviceMesh mesh;
    RecomputedGeometry<double> geometry;
    Real* inverse_diagonal;  ///< [num_nodes, 3, 3]

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t n) const {
        double d[9] = {};
        for (Index k = mesh.corner_offsets[n]; k < mesh.corner_offsets[n + 1]; ++k) {
            const Index corner = mesh.corners[k];
            const std::int64_t t = corner / 4;
            const double* const lame = mesh.lame + 2 * mesh.region[t];
            double block[9];
            tet4_stiffness_block(geometry(t), corner % 4, corner % 4, lame[0], lame[1], block);
            for (int i = 0; i < 9; ++i) d[i] += block[i];
        }
        for (int i = 0; i < 3; ++i)
            if (mesh.prescribed[3 * n + i] || d[4 * i] == 0) {
                for (int j = 0; j < 3; ++j) d[3 * i + j] = d[3 * j + i] = 0;
                d[4 * i] = 1;
            }
        invert(d, inverse_diagonal + 9 * n);
    }

    /// By cofactors: element (i, j) of the inverse is cofactor (j, i) / det.
    KOKKOS_INLINE_FUNCTION static void invert(const double (&d)[9], Real* inverse) {
        double cofactor[9];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                cofactor[3 * i + j] =
                    d[3 * ((i + 1) % 3) + (j + 1) % 3] * d[3 * ((i + 2) % 3) + (j + 2) % 3] -
                    d[3 * ((i + 1) % 3) + (j + 2) % 3] * d[3 * ((i + 2) % 3) + (j + 1) % 3];
        const double determinant = d[0] * cofactor[0] + d[1] * cofactor[1] + d[2] * cofactor[2];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                inverse[3 * i + j] = static_cast<Real>(cofactor[3 * j + i] / determinant);
    }
};

}  // namespace palpate

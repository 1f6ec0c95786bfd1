// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backends/kokkos/tet4_device.hpp"
#include "solver/backends/kokkos/vector_steps.hpp"

// How one block row of an operator multiplies, for `OperatorBody`: from blocks in compressed rows,
// or from the tetrahedra round a node. All have
//   using RealType
//   int block_rows() const                 at most max_block
//   multiply<width>(n, x, columns, product)  product[i] = row i of block row n times x, which
//   points
//                                          to the first of `width` neighbouring columns of
//                                          `columns`
namespace palpate {

/// product[i] += block x for some rows of one dense block.
template <int num_columns, typename Real, int num_rows, int width>
KOKKOS_INLINE_FUNCTION void add_block(const Real* block, const Real* x, Index columns,
                                      Lanes<Real, width> (&product)[num_rows]) {
    for (int j = 0; j < num_columns; ++j) {
        Lanes<Real, width> xj;
        xj.load(x + static_cast<std::int64_t>(j) * columns);
        for (int i = 0; i < num_rows; ++i) product[i].add_product(block[num_columns * i + j], xj);
    }
}

/// Blocks of a size known to the compiler: three rows at a time stay in registers.
template <typename Real, int rows, int block_columns>
struct BlockRows {
    using RealType = Real;
    static constexpr int rows_at_once = rows % 3 == 0 ? 3 : 1;

    const Index* offsets;
    const Index* items;
    const Real* blocks;

    KOKKOS_INLINE_FUNCTION static constexpr int block_rows() { return rows; }

    template <int width>
    KOKKOS_INLINE_FUNCTION void multiply(Index n, const Real* x, Index columns,
                                         Lanes<Real, width> (&product)[max_block]) const {
        for (int i = 0; i < rows; i += rows_at_once) {
            Lanes<Real, width> sum[rows_at_once];
            for (int r = 0; r < rows_at_once; ++r) sum[r].clear();
            for (std::int64_t k = offsets[n]; k < offsets[n + 1]; ++k)
                add_block<block_columns>(
                    blocks + (rows * k + i) * block_columns,
                    x + static_cast<std::int64_t>(items[k]) * block_columns * columns, columns,
                    sum);
            for (int r = 0; r < rows_at_once; ++r) product[i + r] = sum[r];
        }
    }
};

/// Blocks of any other size.
template <typename Real>
struct AnyBlockRows {
    using RealType = Real;

    const Index* offsets;
    const Index* items;
    const Real* blocks;
    int rows;
    int block_columns;

    /// Says to the compiler what the back end has checked.
    KOKKOS_INLINE_FUNCTION int block_rows() const { return rows < max_block ? rows : max_block; }

    template <int width>
    KOKKOS_INLINE_FUNCTION void multiply(Index n, const Real* x, Index columns,
                                         Lanes<Real, width> (&product)[max_block]) const {
        for (int i = 0; i < block_rows(); ++i) {
            Lanes<Real, width> sum[1];
            sum[0].clear();
            for (std::int64_t k = offsets[n]; k < offsets[n + 1]; ++k)
                for (int j = 0; j < block_columns; ++j)
                    add_block<1>(
                        blocks + (rows * k + i) * block_columns + j,
                        x + (static_cast<std::int64_t>(items[k]) * block_columns + j) * columns,
                        columns, sum);
            product[i] = sum[0];
        }
    }
};

/// What element loops read of a model on the device.
struct DeviceMesh {
    const Index* tets;               ///< [num_tets, 4]
    const Index* region;             ///< [num_tets]
    const Index* corner_offsets;     ///< [num_nodes + 1]
    const Index* corners;            ///< 4 tet + corner, of every node
    const double* lame;              ///< [num_regions, 2]: lambda and mu, kPa
    const std::uint8_t* prescribed;  ///< [num_nodes, 3], or null: no dof is
};

/// Nodes gather K x from their tetrahedra, so that nobody adds to the same number; at prescribed
/// dofs rows and columns are those of the identity.
template <typename Real, typename Geometry>
struct ElementRows {
    using RealType = Real;

    DeviceMesh mesh;
    Geometry geometry;

    KOKKOS_INLINE_FUNCTION static constexpr int block_rows() { return 3; }

    template <int width>
    KOKKOS_INLINE_FUNCTION void multiply(Index n, const Real* x, Index columns,
                                         Lanes<Real, width> (&product)[max_block]) const {
        Lanes<Real, width> sum[3];
        for (int i = 0; i < 3; ++i) sum[i].clear();
        for (Index k = mesh.corner_offsets[n]; k < mesh.corner_offsets[n + 1]; ++k) {
            const Index corner = mesh.corners[k];
            const std::int64_t t = corner / 4;
            const double* const lame = mesh.lame + 2 * mesh.region[t];
            const DeviceTet4<Real> tet = geometry(t);
            for (int b = 0; b < 4; ++b) {
                const std::int64_t m = mesh.tets[4 * t + b];
                Real block[9];
                tet4_stiffness_block(tet, corner % 4, b, static_cast<Real>(lame[0]),
                                     static_cast<Real>(lame[1]), block);
                if (mesh.prescribed) clear_columns(m, block);
                add_block<3>(block, x + 3 * m * columns, columns, sum);
            }
        }
        for (int i = 0; i < 3; ++i) {
            const std::int64_t row = 3 * static_cast<std::int64_t>(n) + i;
            if (mesh.prescribed && mesh.prescribed[row]) sum[i].load(x + row * columns);
            product[i] = sum[i];
        }
    }

    KOKKOS_INLINE_FUNCTION void clear_columns(std::int64_t m, Real (&block)[9]) const {
        for (int j = 0; j < 3; ++j)
            if (mesh.prescribed[3 * m + j])
                for (int i = 0; i < 3; ++i) block[3 * i + j] = 0;
    }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backends/kokkos/column_sweep.hpp"

// Bodies of `sweep` whose items are the rows of vectors [rows, columns].
namespace palpate {

/// sums_c += x_c . y_c
template <typename Real>
struct DotBody {
    static constexpr Index part_length = 256;

    const Real* x;
    const Real* y;
    Index columns;

    template <int width>
    KOKKOS_INLINE_FUNCTION void run(Index first, Index last, Index column,
                                    Lanes<double, width>& sums) const {
        for (std::int64_t row = first; row < last; ++row) {
            Lanes<Real, width> xr, yr;
            xr.load(x + row * columns + column);
            yr.load(y + row * columns + column);
            sums.add_wide_product(xr, yr);
        }
    }
};

/// x += step p, r -= step q and sums += r . r, where step = rz / pq for columns that move, else 0.
template <typename Real>
struct AdvanceBody {
    static constexpr Index part_length = 256;

    const double* rz;
    const double* pq;
    const double* rr;
    const double* limit;
    const Real* p;
    const Real* q;
    Real* x;
    Real* r;
    Index columns;

    KOKKOS_INLINE_FUNCTION Real step_of(Index c) const {
        return rr[c] > limit[c] && pq[c] > 0 ? static_cast<Real>(rz[c] / pq[c]) : Real(0);
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void run(Index first, Index last, Index column,
                                    Lanes<double, width>& sums) const {
        Real steps[width];
        for (int c = 0; c < width; ++c) steps[c] = step_of(column + c);
        Lanes<Real, width> step;
        step.load(steps);
        for (std::int64_t row = first; row < last; ++row) {
            const std::int64_t at = row * columns + column;
            Lanes<Real, width> pr, qr, xr, rr_row;
            pr.load(p + at);
            qr.load(q + at);
            xr.load(x + at);
            rr_row.load(r + at);
            xr.add_product(step, pr);
            rr_row.subtract_product(step, qr);
            xr.store(x + at);
            rr_row.store(r + at);
            sums.add_wide_product(rr_row, rr_row);
        }
    }
};

/// p = z + (rz_new / rz) p, or p = z, without a look at the old p, where rz is not positive.
template <typename Real>
struct TurnBody {
    static constexpr Index part_length = 256;

    const double* rz_new;
    const double* rz;
    const Real* z;
    Real* p;
    Index columns;

    template <int width>
    KOKKOS_INLINE_FUNCTION void run(Index first, Index last, Index column,
                                    Lanes<double, width>&) const {
        bool all_turn = true;
        Real factors[width];
        for (int c = 0; c < width; ++c) {
            const bool turns = rz[column + c] > 0;
            all_turn = all_turn && turns;
            factors[c] = turns ? static_cast<Real>(rz_new[column + c] / rz[column + c]) : Real(0);
        }
        Lanes<Real, width> factor;
        factor.load(factors);
        for (std::int64_t row = first; row < last; ++row) {
            const std::int64_t at = row * columns + column;
            Lanes<Real, width> pr, turned;
            if (!all_turn)
                for (int c = 0; c < width; ++c)
                    if (!(rz[column + c] > 0)) p[at + c] = 0;
            pr.load(p + at);
            turned.load(z + at);
            turned.add_product(factor, pr);
            turned.store(p + at);
        }
    }
};

/// to[:, to_columns[i]] = from[:, from_columns[i]], one row after the other, i ascending.
template <typename From, typename To>
struct CopyColumns {
    ConstArray<From> from;
    ConstArray<Index> from_columns;
    Array<To> to;
    ConstArray<Index> to_columns;
    Index columns_of_from;
    Index columns_of_to;

    KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row) const {
        for (std::size_t i = 0; i < from_columns.size(); ++i)
            to(row * columns_of_to + to_columns(i)) =
                static_cast<To>(from(row * columns_of_from + from_columns(i)));
    }
};

/// out = weight D in with one block D of `block` rows.
template <typename Real, int width>
KOKKOS_INLINE_FUNCTION void multiply_block(const Real* d, int block, Real weight,
                                           const Lanes<Real, width> (&in)[max_block],
                                           Lanes<Real, width> (&out)[max_block]) {
    for (int i = 0; i < block; ++i) {
        out[i].clear();
        for (int j = 0; j < block; ++j) out[i].add_product(d[block * i + j], in[j]);
        out[i].scale(weight);
    }
}

/// z = weight D^-1 r and sums += r . z; items are block rows of D, [items, block, block]. z may be
/// r.
template <typename Real>
struct InverseDiagonalBody {
    static constexpr Index part_length = 64;

    const Real* inverse_diagonal;
    int block;
    Real weight;
    const Real* r;
    Real* z;
    Index columns;

    template <int width>
    KOKKOS_INLINE_FUNCTION void run(Index first, Index last, Index column,
                                    Lanes<double, width>& sums) const {
        if (block == 3)
            run_blocks<width>(3, first, last, column, sums);  // a number that the compiler knows
        else
            run_blocks<width>(block < max_block ? block : max_block, first, last, column, sums);
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void run_blocks(int b, Index first, Index last, Index column,
                                           Lanes<double, width>& sums) const {
        Lanes<Real, width> in[max_block], out[max_block];
        for (std::int64_t n = first; n < last; ++n) {
            const std::int64_t at = n * b * columns + column;
            for (int i = 0; i < b; ++i) in[i].load(r + at + static_cast<std::int64_t>(i) * columns);
            multiply_block(inverse_diagonal + n * b * b, b, weight, in, out);
            for (int i = 0; i < b; ++i) {
                sums.add_wide_product(in[i], out[i]);
                out[i].store(z + at + static_cast<std::int64_t>(i) * columns);
            }
        }
    }
};

}  // namespace palpate

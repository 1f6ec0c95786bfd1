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
                                    double (&sums)[width]) const {
        for (std::int64_t row = first; row < last; ++row) {
            const Real* const xr = x + row * columns + column;
            const Real* const yr = y + row * columns + column;
            for (int c = 0; c < width; ++c)
                sums[c] += static_cast<double>(xr[c]) * static_cast<double>(yr[c]);
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
                                    double (&sums)[width]) const {
        Real step[width];
        for (int c = 0; c < width; ++c) step[c] = step_of(column + c);
        for (std::int64_t row = first; row < last; ++row) {
            const std::int64_t start = row * columns + column;
            Real new_x[width], new_r[width];
            for (int c = 0; c < width; ++c) {
                new_x[c] = x[start + c] + step[c] * p[start + c];
                new_r[c] = r[start + c] - step[c] * q[start + c];
            }
            for (int c = 0; c < width; ++c) {
                x[start + c] = new_x[c];
                r[start + c] = new_r[c];
                sums[c] += static_cast<double>(new_r[c]) * static_cast<double>(new_r[c]);
            }
        }
    }
};

/// p = z + (rz_new / rz) p, or p = z where rz is not positive.
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
                                    double (&)[width]) const {
        bool keeps[width];
        Real factor[width];
        for (int c = 0; c < width; ++c) {
            keeps[c] = rz[column + c] > 0;
            factor[c] = keeps[c] ? static_cast<Real>(rz_new[column + c] / rz[column + c]) : Real(0);
        }
        for (std::int64_t row = first; row < last; ++row) {
            const std::int64_t start = row * columns + column;
            Real turned[width];
            for (int c = 0; c < width; ++c) {
                const Real old = keeps[c] ? p[start + c] : Real(0);
                turned[c] = z[start + c] + factor[c] * old;
            }
            for (int c = 0; c < width; ++c) p[start + c] = turned[c];
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

/// out = weight D in with one block D of at most `max_block` rows, both as local rows of some
/// columns.
constexpr int max_block = 6;

template <int width, typename Real>
KOKKOS_INLINE_FUNCTION void multiply_block(const Real* d, int block, Real weight,
                                           const Real (&in)[max_block][width],
                                           Real (&out)[max_block][width]) {
    for (int i = 0; i < block; ++i) {
        Real sum[width] = {};
        for (int j = 0; j < block; ++j)
            for (int c = 0; c < width; ++c) sum[c] += d[block * i + j] * in[j][c];
        for (int c = 0; c < width; ++c) out[i][c] = weight * sum[c];
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
                                    double (&sums)[width]) const {
        Real in[max_block][width], out[max_block][width];
        for (std::int64_t n = first; n < last; ++n) {
            const std::int64_t start = n * block * columns + column;
            for (int i = 0; i < block; ++i)
                for (int c = 0; c < width; ++c)
                    in[i][c] = r[start + static_cast<std::int64_t>(i) * columns + c];
            multiply_block(inverse_diagonal + n * block * block, block, weight, in, out);
            for (int i = 0; i < block; ++i)
                for (int c = 0; c < width; ++c) {
                    sums[c] += static_cast<double>(in[i][c]) * static_cast<double>(out[i][c]);
                    z[start + static_cast<std::int64_t>(i) * columns + c] = out[i][c];
                }
        }
    }
};

}  // namespace palpate

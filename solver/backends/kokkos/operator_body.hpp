// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backends/kokkos/operator_rows.hpp"

namespace palpate {

/// One pass over an operator A (see `RowResult`): `apply` adds x . y to the sums if A is square,
/// `smooth` adds b . y.
template <typename Real>
struct OperatorStep {
    RowResult result;
    const Real* x;
    const Real* b;
    Real* y;
    const Real* inverse_diagonal;
    Real alpha;
    Real beta;
    Real weight;
    Index columns;
    bool is_square;
};

/// Items are the block rows of A.
template <typename Rows>
struct OperatorBody {
    using Real = typename Rows::RealType;
    static constexpr Index part_length = 32;

    Rows rows;
    OperatorStep<Real> step;

    template <int width>
    KOKKOS_INLINE_FUNCTION void run(Index first, Index last, Index column,
                                    Lanes<double, width>& sums) const {
        Lanes<Real, width> product[max_block];
        for (Index n = first; n < last; ++n) {
            rows.template multiply<width>(n, step.x + column, step.columns, product);
            const std::int64_t at =
                static_cast<std::int64_t>(n) * rows.block_rows() * step.columns + column;
            if (step.result == RowResult::smooth)
                smooth(n, at, product, sums);
            else
                for (int i = 0; i < rows.block_rows(); ++i)
                    write_row(at + static_cast<std::int64_t>(i) * step.columns, product[i], sums);
        }
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void write_row(std::int64_t at, Lanes<Real, width>& product,
                                          Lanes<double, width>& sums) const {
        Lanes<Real, width> other;
        if (step.result == RowResult::apply && step.is_square) {
            other.load(step.x + at);
            sums.add_wide_product(other, product);
        } else if (step.result == RowResult::add) {
            other.load(step.y + at);
            product.add(other);
        } else if (step.result == RowResult::residual) {
            other.load(step.b + at);
            product.subtract_from(other);
        }
        product.store(step.y + at);
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void smooth(std::int64_t n, std::int64_t at,
                                       Lanes<Real, width> (&rest)[max_block],
                                       Lanes<double, width>& sums) const {
        const int block = rows.block_rows();
        Lanes<Real, width> change[max_block], other;
        for (int i = 0; i < block; ++i) {
            other.load(step.b + at + static_cast<std::int64_t>(i) * step.columns);
            rest[i].subtract_from(other);
        }
        multiply_block(step.inverse_diagonal + n * block * block, block, step.weight, rest, change);
        for (int i = 0; i < block; ++i) {
            const std::int64_t row = at + static_cast<std::int64_t>(i) * step.columns;
            if (step.beta != 0) {
                other.load(step.y + row);
                change[i].add_product(step.beta, other);
            }
            other.load(step.x + row);
            change[i].add_product(step.alpha, other);
            other.load(step.b + row);
            sums.add_wide_product(other, change[i]);
            change[i].store(step.y + row);
        }
    }
};

}  // namespace palpate

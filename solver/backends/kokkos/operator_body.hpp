// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backends/kokkos/operator_rows.hpp"

namespace palpate {

enum class StepKind { product, add, residual, smooth };

/// What one pass over an operator A does, by kind:
///   product   y = A x,                                      sums += x . y (A square)
///   add       y += A x
///   residual  y = b - A x
///   smooth    y = alpha x + beta y + weight D^-1 (b - A x),  sums += b . y (A square)
/// With beta == 0 the old y is not read.
template <typename Real>
struct OperatorStep {
    StepKind kind;
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
                                    double (&sums)[width]) const {
        Real product[max_block][width];
        for (Index n = first; n < last; ++n) {
            rows.template multiply<width>(n, step.x + column, step.columns, product);
            const std::int64_t start =
                static_cast<std::int64_t>(n) * rows.block_rows() * step.columns + column;
            if (step.kind == StepKind::smooth)
                smooth(n, start, product, sums);
            else
                for (int i = 0; i < rows.block_rows(); ++i)
                    write_row(start + static_cast<std::int64_t>(i) * step.columns, product[i],
                              sums);
        }
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void write_row(std::int64_t at, const Real (&product)[width],
                                          double (&sums)[width]) const {
        if (step.kind == StepKind::product)
            for (int c = 0; c < width; ++c) step.y[at + c] = product[c];
        else if (step.kind == StepKind::add)
            for (int c = 0; c < width; ++c) step.y[at + c] += product[c];
        else
            for (int c = 0; c < width; ++c) step.y[at + c] = step.b[at + c] - product[c];
        if (step.is_square && step.kind == StepKind::product)
            for (int c = 0; c < width; ++c)
                sums[c] += static_cast<double>(step.x[at + c]) * static_cast<double>(product[c]);
    }

    template <int width>
    KOKKOS_INLINE_FUNCTION void smooth(std::int64_t n, std::int64_t start,
                                       const Real (&product)[max_block][width],
                                       double (&sums)[width]) const {
        const int block = rows.block_rows();
        Real rest[max_block][width], change[max_block][width];
        for (int i = 0; i < block; ++i)
            for (int c = 0; c < width; ++c)
                rest[i][c] =
                    step.b[start + static_cast<std::int64_t>(i) * step.columns + c] - product[i][c];
        multiply_block(step.inverse_diagonal + n * block * block, block, step.weight, rest, change);
        for (int i = 0; i < block; ++i) {
            const std::int64_t at = start + static_cast<std::int64_t>(i) * step.columns;
            if (step.beta != 0)
                for (int c = 0; c < width; ++c) change[i][c] += step.beta * step.y[at + c];
            for (int c = 0; c < width; ++c) {
                change[i][c] += step.alpha * step.x[at + c];
                sums[c] += static_cast<double>(step.b[at + c]) * static_cast<double>(change[i][c]);
            }
            for (int c = 0; c < width; ++c) step.y[at + c] = change[i][c];
        }
    }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// What a product A x is used for, row by row. After the product loop of a kernel holds A x at one
// block row, `finish_rows` does the rest of
//   MODE 0  y = A x                                       sum: x . A x
//   MODE 1  y += A x
//   MODE 2  y = b - A x
//   MODE 3  y = alpha x + beta y + weight D^-1 (b - A x)  sum: b . y
// and returns the row's share of the sum (where HAS_SUM). With beta == 0 the old y is not read.
//   ax                this row of A x
//   inverse_diagonal  [num_rows, BLOCK_ROWS, BLOCK_ROWS], symmetric
//   b, x, y           [BLOCK_ROWS num_rows, num_columns]; y is neither b nor x
// Defines: MODE, HAS_SUM, BLOCK_ROWS.
#if !defined(MODE) || !defined(HAS_SUM) || !defined(BLOCK_ROWS)
#error "MODE, HAS_SUM and BLOCK_ROWS must be defined"
#endif

static inline wide_columns finish_rows(const columns* ax, global const real* inverse_diagonal,
                                       global const real* b, global const real* x, global real* y,
                                       real alpha, real beta, real weight, size_t row,
                                       size_t num_columns, size_t column) {
    wide_columns sum = (wide_columns)(0);
    const size_t at = BLOCK_ROWS * row * num_columns + column;
#if MODE == 3
    columns r[BLOCK_ROWS];
#pragma unroll
    for (int i = 0; i < BLOCK_ROWS; ++i) r[i] = LOAD_COLUMNS(b + at + i * num_columns) - ax[i];
    global const real* d = inverse_diagonal + BLOCK_ROWS * BLOCK_ROWS * row;
#endif
#pragma unroll
    for (int i = 0; i < BLOCK_ROWS; ++i) {
        const size_t here = at + i * num_columns;
#if MODE == 0
        STORE_COLUMNS(ax[i], y + here);
#if HAS_SUM
        sum += WIDEN_COLUMNS(LOAD_COLUMNS(x + here)) * WIDEN_COLUMNS(ax[i]);
#endif
#elif MODE == 1
        STORE_COLUMNS(LOAD_COLUMNS(y + here) + ax[i], y + here);
#elif MODE == 2
        STORE_COLUMNS(LOAD_COLUMNS(b + here) - ax[i], y + here);
#else
        columns scaled = d[BLOCK_ROWS * i] * r[0];
#pragma unroll
        for (int j = 1; j < BLOCK_ROWS; ++j) scaled += d[BLOCK_ROWS * i + j] * r[j];
        columns result = alpha * LOAD_COLUMNS(x + here) + weight * scaled;
        if (beta != 0) result += beta * LOAD_COLUMNS(y + here);
        STORE_COLUMNS(result, y + here);
#if HAS_SUM
        sum += WIDEN_COLUMNS(LOAD_COLUMNS(b + here)) * WIDEN_COLUMNS(result);
#endif
#endif
    }
    return sum;
}

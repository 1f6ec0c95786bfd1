// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// z = weight D^-1 r with inverted diagonal blocks. The block rows are cut into parts (parts.cl).
//   inverse_diagonal  [num_rows, BLOCK_ROWS, BLOCK_ROWS], symmetric
//   r, z              [BLOCK_ROWS num_rows, num_columns]; may be the same
//   parts             [number of parts, num_columns] of r . z, if HAS_SUM
// Defines: BLOCK_ROWS, HAS_SUM.
#if !defined(BLOCK_ROWS) || !defined(HAS_SUM)
#error "BLOCK_ROWS and HAS_SUM must be defined"
#endif

PALPATE_KERNEL void apply_inverse_diagonal(global const real* inverse_diagonal,
                                           global const real* r, global real* z, real weight,
                                           global wide* parts, int num_rows, int num_columns,
                                           int first_column) {
    const size_t column = column_of_item(first_column);
    const size_t end = column < (size_t)num_columns ? END_ROW(num_rows) : 0;
    START_SUM(sum);
    for (size_t row = FIRST_ROW(num_rows); row < end; row += ROW_STEP) {
        const size_t at = BLOCK_ROWS * row * num_columns + column;
        global const real* d = inverse_diagonal + BLOCK_ROWS * BLOCK_ROWS * row;
        columns here[BLOCK_ROWS];
#pragma unroll
        for (int i = 0; i < BLOCK_ROWS; ++i) here[i] = LOAD_COLUMNS(r + at + i * num_columns);
#pragma unroll
        for (int i = 0; i < BLOCK_ROWS; ++i) {
            columns scaled = d[BLOCK_ROWS * i] * here[0];
#pragma unroll
            for (int j = 1; j < BLOCK_ROWS; ++j) scaled += d[BLOCK_ROWS * i + j] * here[j];
            scaled *= weight;
            STORE_COLUMNS(scaled, z + at + i * num_columns);
#if HAS_SUM
            ADD_SHARE(sum, WIDEN_COLUMNS(here[i]) * WIDEN_COLUMNS(scaled));
#endif
        }
    }
#if HAS_SUM
    SUM_SCRATCH
    STORE_PART(sum, parts, num_columns, column);
#endif
}

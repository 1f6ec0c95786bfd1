// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// A x for a matrix of dense blocks in compressed rows, and what row_result.cl makes of it. The
// block rows are cut into parts (parts.cl); a block row is summed in its stored order by one work
// item per COLUMN_WIDTH columns, which alone writes its rows of y.
//   row_start   [num_rows + 1]
//   block_node  [num_blocks] block columns
//   blocks      [num_blocks, BLOCK_COLUMNS, BLOCK_ROWS] column by column, then 4 unused reals
//   x           [BLOCK_COLUMNS number of block columns, num_columns]
//   parts       [number of parts, num_columns] of the sum, if HAS_SUM
// Defines: BLOCK_COLUMNS, and those of row_result.cl.
#ifndef BLOCK_COLUMNS
#error "BLOCK_COLUMNS must be defined"
#endif
#define BLOCK_REALS (BLOCK_ROWS * BLOCK_COLUMNS)

// Independent sums hide the latency of multiply-add where a row alone has too few.
#if BLOCK_ROWS <= 3
#define NUM_SUMS 3
#else
#define NUM_SUMS 1
#endif

#if COLUMN_WIDTH == 1 && DEVICE_IS_CPU
// One column: the rows of a block side by side in a vector, whose surplus entries are unused.
#if BLOCK_ROWS <= 4
typedef real4 block_column;
#define LOAD_BLOCK_COLUMN(pointer) vload4(0, pointer)
#define STORE_BLOCK_COLUMN(value, pointer) vstore4(value, 0, pointer)
#else
typedef real8 block_column;
#define LOAD_BLOCK_COLUMN(pointer) vload8(0, pointer)
#define STORE_BLOCK_COLUMN(value, pointer) vstore8(value, 0, pointer)
#endif

static inline void multiply_row(global const int* row_start, global const int* block_node,
                                global const real* blocks, global const real* x, size_t row,
                                size_t num_columns, size_t column, columns* ax) {
    block_column sum[NUM_SUMS];
#pragma unroll
    for (int s = 0; s < NUM_SUMS; ++s) sum[s] = (block_column)(0);
    const int end = row_start[row + 1];
    for (int k = row_start[row]; k < end; ++k) {
        global const real* block = blocks + (size_t)BLOCK_REALS * k;
        global const real* u = x + (size_t)BLOCK_COLUMNS * block_node[k] * num_columns + column;
#pragma unroll
        for (int j = 0; j < BLOCK_COLUMNS; ++j)
            sum[j % NUM_SUMS] += LOAD_BLOCK_COLUMN(block + BLOCK_ROWS * j) * u[j * num_columns];
    }
    block_column total = sum[0];
#pragma unroll
    for (int s = 1; s < NUM_SUMS; ++s) total += sum[s];
    real entries[8];
    STORE_BLOCK_COLUMN(total, entries);
#pragma unroll
    for (int i = 0; i < BLOCK_ROWS; ++i) ax[i] = entries[i];
}
#else
static inline void multiply_row(global const int* row_start, global const int* block_node,
                                global const real* blocks, global const real* x, size_t row,
                                size_t num_columns, size_t column, columns* ax) {
    columns sum[NUM_SUMS][BLOCK_ROWS];
#pragma unroll
    for (int s = 0; s < NUM_SUMS; ++s)
#pragma unroll
        for (int i = 0; i < BLOCK_ROWS; ++i) sum[s][i] = (columns)(0);
    const int end = row_start[row + 1];
    for (int k = row_start[row]; k < end; ++k) {
        global const real* block = blocks + (size_t)BLOCK_REALS * k;
        global const real* u = x + (size_t)BLOCK_COLUMNS * block_node[k] * num_columns + column;
#pragma unroll
        for (int j = 0; j < BLOCK_COLUMNS; ++j) {
            const columns uj = LOAD_COLUMNS(u + j * num_columns);
#pragma unroll
            for (int i = 0; i < BLOCK_ROWS; ++i)
                sum[j % NUM_SUMS][i] += block[BLOCK_ROWS * j + i] * uj;
        }
    }
#pragma unroll
    for (int i = 0; i < BLOCK_ROWS; ++i) {
        ax[i] = sum[0][i];
#pragma unroll
        for (int s = 1; s < NUM_SUMS; ++s) ax[i] += sum[s][i];
    }
}
#endif

PALPATE_KERNEL void multiply_blocks(global const int* restrict row_start,
                                    global const int* restrict block_node,
                                    global const real* restrict blocks,
                                    global const real* restrict inverse_diagonal,
                                    global const real* restrict b, global const real* restrict x,
                                    global real* restrict y, real alpha, real beta, real weight,
                                    global wide* restrict parts, int num_rows, int num_columns,
                                    int first_column) {
    const size_t column = column_of_item(first_column);
    const size_t end = column < (size_t)num_columns ? END_ROW(num_rows) : 0;
    START_SUM(sum);
    for (size_t row = FIRST_ROW(num_rows); row < end; row += ROW_STEP) {
        columns ax[BLOCK_ROWS];
        multiply_row(row_start, block_node, blocks, x, row, num_columns, column, ax);
        const wide_columns share = finish_rows(ax, inverse_diagonal, b, x, y, alpha, beta, weight,
                                               row, num_columns, column);
        ADD_SHARE(sum, share);
    }
#if HAS_SUM
    SUM_SCRATCH
    STORE_PART(sum, parts, num_columns, column);
#endif
}

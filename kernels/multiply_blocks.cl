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

#if COLUMN_WIDTH == 1 && DEVICE_IS_CPU && BLOCK_ROWS == 3 && BLOCK_COLUMNS == 3
// One column: eight entries of a block meet the eight factors they belong to, the ninth goes alone;
// two blocks at a time, so that their sums do not wait for each other.
#define ADD_BLOCK(k, sum, last)                                                          \
    {                                                                                    \
        global const real* block = blocks + (size_t)BLOCK_REALS * (k);                   \
        global const real* at = x + (size_t)3 * block_node[k] * num_columns + column;    \
        const real4 u = (real4)(at[0], at[num_columns], at[(size_t)2 * num_columns], 0); \
        sum += vload8(0, block) * u.s00011122;                                           \
        last += block[8] * u.s2;                                                         \
    }

static inline void multiply_row(global const int* row_start, global const int* block_node,
                                global const real* blocks, global const real* x, size_t row,
                                size_t num_columns, size_t column, columns* ax) {
    real8 sum0 = (real8)(0), sum1 = (real8)(0);
    real last0 = 0, last1 = 0;
    const int end = row_start[row + 1];
    int k = row_start[row];
    for (; k + 1 < end; k += 2) {
        ADD_BLOCK(k, sum0, last0)
        ADD_BLOCK(k + 1, sum1, last1)
    }
    if (k < end) ADD_BLOCK(k, sum0, last0)
    const real8 sum = sum0 + sum1;
    ax[0] = sum.s0 + sum.s3 + sum.s6;
    ax[1] = sum.s1 + sum.s4 + sum.s7;
    ax[2] = sum.s2 + sum.s5 + (last0 + last1);
}
#elif COLUMN_WIDTH == 1 && DEVICE_IS_CPU
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

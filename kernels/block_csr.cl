// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// y = A x for a matrix of 3x3 blocks in compressed rows. One work item: one block row,
// COLUMN_WIDTH columns; it alone writes its rows of y. Blocks are summed in their stored order.
//   row_start   [num_nodes + 1]
//   block_node  [num_blocks]
//   blocks      [num_blocks, 9] column by column, followed by at least 3 unused reals
//   x, y        [3 num_nodes, num_columns], not the same
PALPATE_KERNEL void block_csr_apply(global const int* restrict row_start,
                                    global const int* restrict block_node,
                                    global const real* restrict blocks,
                                    global const real* restrict x, global real* restrict y,
                                    int num_nodes, int num_columns, int first_column) {
    const size_t node = get_global_id(1);
    const size_t column = column_of_item(first_column);
    if (node >= (size_t)num_nodes || column >= (size_t)num_columns) return;

    const int end = row_start[node + 1];
    const size_t at = 3 * node * num_columns + column;
#if COLUMN_WIDTH == 1 && DEVICE_IS_CPU
    // One column: the three rows of a block side by side in a vector, whose last entry is unused.
    real4 sum0 = (real4)(0), sum1 = (real4)(0), sum2 = (real4)(0);
    for (int k = row_start[node]; k < end; ++k) {
        global const real* block = blocks + (size_t)9 * k;
        global const real* u = x + (size_t)3 * block_node[k] * num_columns + column;
        sum0 += vload4(0, block) * u[0];
        sum1 += vload4(0, block + 3) * u[num_columns];
        sum2 += vload4(0, block + 6) * u[(size_t)2 * num_columns];
    }
    const real4 sum = sum0 + sum1 + sum2;
    y[at] = sum.x;
    y[at + num_columns] = sum.y;
    y[at + (size_t)2 * num_columns] = sum.z;
#else
    columns sum[9];
#pragma unroll
    for (int i = 0; i < 9; ++i) sum[i] = (columns)(0);
    for (int k = row_start[node]; k < end; ++k) {
        global const real* block = blocks + (size_t)9 * k;
        global const real* u = x + (size_t)3 * block_node[k] * num_columns + column;
        const columns u0 = LOAD_COLUMNS(u);
        const columns u1 = LOAD_COLUMNS(u + num_columns);
        const columns u2 = LOAD_COLUMNS(u + (size_t)2 * num_columns);
#pragma unroll
        for (int i = 0; i < 3; ++i) {
            sum[i] += block[i] * u0;
            sum[3 + i] += block[3 + i] * u1;
            sum[6 + i] += block[6 + i] * u2;
        }
    }
#pragma unroll
    for (int i = 0; i < 3; ++i)
        STORE_COLUMNS(sum[i] + sum[3 + i] + sum[6 + i], y + at + (size_t)i * num_columns);
#endif
}

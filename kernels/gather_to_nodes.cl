// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Matrix-free product, node half: sums the element forces at each node, elements in ascending
// order, and what row_result.cl makes of it. The nodes are cut into parts (parts.cl); one work item
// has COLUMN_WIDTH columns of a node and alone writes its rows of y.
//   node_start    [num_nodes + 1] into node_corners
//   node_corners  [4 num_elements] 4 element + local node
//   forces        [num_elements, 4, 3, num_pass_columns] mN
//   prescribed    [3 num_nodes]; if CONSTRAINED, A x = x at prescribed dofs
//   parts         [number of parts, num_columns] of the sum, if HAS_SUM
// Other buffers as in row_result.cl. Defines: CONSTRAINED, and those of row_result.cl.
#ifndef CONSTRAINED
#error "CONSTRAINED must be defined"
#endif

PALPATE_KERNEL void gather_to_nodes(global const int* node_start, global const int* node_corners,
                                    global const real* forces, global const uchar* prescribed,
                                    global const real* inverse_diagonal, global const real* b,
                                    global const real* x, global real* y, real alpha, real beta,
                                    real weight, global wide* parts, int num_nodes, int num_columns,
                                    int first_column, int num_pass_columns) {
    const size_t pass_column = column_of_item(0);
    const size_t column = first_column + pass_column;
    const size_t last = pass_column < (size_t)num_pass_columns ? END_ROW(num_nodes) : 0;
    START_SUM(sum);
    for (size_t node = FIRST_ROW(num_nodes); node < last; node += ROW_STEP) {
        columns ax[3] = {(columns)(0), (columns)(0), (columns)(0)};
        const int end = node_start[node + 1];
        for (int k = node_start[node]; k < end; ++k) {
            global const real* f =
                forces + (size_t)3 * node_corners[k] * num_pass_columns + pass_column;
#pragma unroll
            for (int c = 0; c < 3; ++c) ax[c] += LOAD_COLUMNS(f + (size_t)c * num_pass_columns);
        }
#if CONSTRAINED
#pragma unroll
        for (int c = 0; c < 3; ++c)
            if (prescribed[3 * node + c])
                ax[c] = LOAD_COLUMNS(x + (3 * node + c) * num_columns + column);
#endif
        const wide_columns share = finish_rows(ax, inverse_diagonal, b, x, y, alpha, beta, weight,
                                               node, num_columns, column);
        ADD_SHARE(sum, share);
    }
#if HAS_SUM
    SUM_SCRATCH
    STORE_PART(sum, parts, num_columns, column);
#endif
}

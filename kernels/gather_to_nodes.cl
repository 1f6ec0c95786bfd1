// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Matrix-free product, node half: sums the element forces at each node, elements in ascending
// order. One work item: one node, COLUMN_WIDTH columns; it alone writes the node's rows of y.
//   node_start    [num_nodes + 1] into node_corners
//   node_corners  [4 num_elements] 4 element + local node
//   forces        [num_elements, 4, 3, num_pass_columns] mN
//   prescribed    [3 num_nodes]
//   x, y          [3 num_nodes, num_columns]; if CONSTRAINED, y = x at prescribed dofs
// Define: CONSTRAINED 0 or 1.
#ifndef CONSTRAINED
#error "CONSTRAINED must be defined"
#endif

PALPATE_KERNEL void gather_to_nodes(global const int* node_start, global const int* node_corners,
                                    global const real* forces, global const uchar* prescribed,
                                    global const real* x, global real* y, int num_nodes,
                                    int num_columns, int first_column, int num_pass_columns) {
    const size_t node = get_global_id(1);
    const size_t pass_column = column_of_item(0);
    if (node >= (size_t)num_nodes || pass_column >= (size_t)num_pass_columns) return;

    columns sum[3] = {(columns)(0), (columns)(0), (columns)(0)};
    const int end = node_start[node + 1];
    for (int k = node_start[node]; k < end; ++k) {
        global const real* f =
            forces + (size_t)3 * node_corners[k] * num_pass_columns + pass_column;
#pragma unroll
        for (int c = 0; c < 3; ++c) sum[c] += LOAD_COLUMNS(f + (size_t)c * num_pass_columns);
    }
#pragma unroll
    for (int c = 0; c < 3; ++c) {
        const size_t dof = 3 * node + c;
        const size_t at = dof * num_columns + first_column + pass_column;
#if CONSTRAINED
        if (prescribed[dof]) sum[c] = LOAD_COLUMNS(x + at);
#endif
        STORE_COLUMNS(sum[c], y + at);
    }
}

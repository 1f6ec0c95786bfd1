// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// z = D^-1 r with the inverted 3x3 diagonal blocks of the stiffness. One work item: one node,
// COLUMN_WIDTH columns; it alone writes the node's rows of z.
//   inverse_blocks  [num_nodes, 9] mm/mN
//   r, z            [3 num_nodes, num_columns] mN, mm; may be the same
PALPATE_KERNEL void block_jacobi(global const real* inverse_blocks, global const real* r,
                                 global real* z, int num_nodes, int num_columns, int first_column) {
    const size_t node = get_global_id(1);
    const size_t column = column_of_item(first_column);
    if (node >= (size_t)num_nodes || column >= (size_t)num_columns) return;

    global const real* d = inverse_blocks + 9 * node;
    const size_t at = 3 * node * num_columns + column;
    const columns r0 = LOAD_COLUMNS(r + at);
    const columns r1 = LOAD_COLUMNS(r + at + num_columns);
    const columns r2 = LOAD_COLUMNS(r + at + (size_t)2 * num_columns);
    STORE_COLUMNS(d[0] * r0 + d[1] * r1 + d[2] * r2, z + at);
    STORE_COLUMNS(d[3] * r0 + d[4] * r1 + d[5] * r2, z + at + num_columns);
    STORE_COLUMNS(d[6] * r0 + d[7] * r1 + d[8] * r2, z + at + (size_t)2 * num_columns);
}

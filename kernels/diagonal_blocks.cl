// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Inverted 3x3 diagonal blocks of the constrained stiffness, and their product with vectors
// (block-Jacobi). One work item: one node, which alone writes the node's block or rows.
//   inverse_blocks  [num_nodes, 9] mm/mN, symmetric
// Other buffers as in stiffness_blocks.cl.
PALPATE_KERNEL void invert_diagonal_blocks(
    global const int* region, global const real* geometry, global const real* unit_moduli,
    global const real* stiffness, global const uchar* prescribed, global const int* node_start,
    global const int* node_corners, global real* inverse_blocks, int num_nodes) {
    const size_t node = get_global_id(1);
    if (node >= (size_t)num_nodes) return;

    real block[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (int k = node_start[node]; k < node_start[node + 1]; ++k) {
        const size_t element = node_corners[k] / NODES_PER_ELEMENT;
        const int corner = node_corners[k] % NODES_PER_ELEMENT;
        const element_shape shape = load_element(geometry, element);
        const material law = load_material(unit_moduli, region[element]);
        add_material_block(&law, shape.gradient[corner], shape.gradient[corner],
                           stiffness[region[element]] * shape.volume, block);
    }

    wide constrained[9];
    wide inverse[9];
#pragma unroll
    for (int i = 0; i < 3; ++i)
#pragma unroll
        for (int j = 0; j < 3; ++j) {
            const bool given = prescribed[3 * node + i] || prescribed[3 * node + j];
            constrained[3 * i + j] = given ? (wide)(i == j) : (wide)block[3 * i + j];
        }
    invert_symmetric(constrained, inverse);
#pragma unroll
    for (int i = 0; i < 9; ++i) inverse_blocks[9 * node + i] = (real)inverse[i];
}

// z = D^-1 r for COLUMN_WIDTH columns of [3 num_nodes, num_columns]; r and z may be the same.
PALPATE_KERNEL void apply_diagonal_blocks(global const real* inverse_blocks, global const real* r,
                                          global real* z, int num_nodes, int num_columns,
                                          int first_column) {
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

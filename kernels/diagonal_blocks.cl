// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Inverted 3x3 diagonal blocks of the constrained stiffness, for block-Jacobi. One work item: one
// node, which alone writes the node's block.
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

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// The constrained stiffness as 3x3 blocks: K_ij = sum over elements of E V block(grad N_i, grad
// N_j), elements in ascending order; rows and columns of prescribed dofs are those of the identity.
// One work item: one node, which alone writes its block row.
//   node_start    [num_nodes + 1] into node_corners
//   node_corners  [4 num_elements] 4 element + local node
//   corner_slots  [4 num_elements, 4] position of the element's nodes in the corner's block row
//   row_start     [num_nodes + 1] into block_node and blocks
//   block_node    [num_blocks] node of the block's column, ascending in each row
//   blocks        [num_blocks, 9] mN/mm, column by column: entry (i, j) at 3 j + i
PALPATE_KERNEL void stiffness_blocks(global const int* region, global const real* geometry,
                                     global const real* unit_moduli, global const real* stiffness,
                                     global const uchar* prescribed, global const int* node_start,
                                     global const int* node_corners,
                                     global const ushort* corner_slots, global const int* row_start,
                                     global const int* block_node, global real* blocks,
                                     int num_nodes) {
    const size_t node = get_global_id(1);
    if (node >= (size_t)num_nodes) return;

    global real* row = blocks + (size_t)9 * row_start[node];
    const int num_blocks = row_start[node + 1] - row_start[node];
    for (int k = 0; k < 9 * num_blocks; ++k) row[k] = 0;

    for (int k = node_start[node]; k < node_start[node + 1]; ++k) {
        const size_t element = node_corners[k] / NODES_PER_ELEMENT;
        const int corner = node_corners[k] % NODES_PER_ELEMENT;
        const element_shape shape = load_element(geometry, element);
        const material law = load_material(unit_moduli, region[element]);
        const real scale = stiffness[region[element]] * shape.volume;
#pragma unroll
        for (int b = 0; b < NODES_PER_ELEMENT; ++b) {
            // Block (j, i) of the pair is the transpose of (i, j): gives column-by-column order.
            real block[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
            add_material_block(&law, shape.gradient[b], shape.gradient[corner], scale, block);
            global real* target = row + 9 * corner_slots[(size_t)NODES_PER_ELEMENT * k + b];
#pragma unroll
            for (int i = 0; i < 9; ++i) target[i] += block[i];
        }
    }

    for (int k = 0; k < num_blocks; ++k) {
        const size_t other = block_node[row_start[node] + k];
#pragma unroll
        for (int j = 0; j < 3; ++j)
#pragma unroll
            for (int i = 0; i < 3; ++i)
                if (prescribed[3 * node + i] || prescribed[3 * other + j])
                    row[9 * k + 3 * j + i] = (other == node && i == j) ? 1 : 0;
    }
}

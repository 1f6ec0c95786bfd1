// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Sums the 3x3 blocks of elements into those of the matrix, elements in ascending order. One work
// item: one block of the matrix, which it alone writes.
//   block_start   [num_blocks + 1] into block_items
//   block_items   [number of element blocks]
//   parts         [number of element blocks, 9]
//   blocks        [num_blocks, 9]
PALPATE_KERNEL void gather_blocks(global const int* block_start, global const int* block_items,
                                  global const real* parts, global real* blocks, int num_blocks) {
    const size_t block = get_global_id(1);
    if (block >= (size_t)num_blocks) return;

    real sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    const int end = block_start[block + 1];
    for (int k = block_start[block]; k < end; ++k) {
        global const real* part = parts + (size_t)9 * block_items[k];
        for (int i = 0; i < 9; ++i) sum[i] += part[i];
    }
    for (int i = 0; i < 9; ++i) blocks[9 * block + i] = sum[i];
}

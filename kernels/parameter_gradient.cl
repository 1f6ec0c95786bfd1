// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Partial sums of lambda_c . K_r x_c = sum over the elements of region r of
// V strain(lambda_c) : stress(x_c) at unit modulus. With lambda = x this is twice the strain
// energy. One work item: one chunk of elements of one region, COLUMN_WIDTH columns.
//   elements        [num_elements, 4]
//   region_order    [num_elements] elements sorted by region
//   chunk_start     [num_chunks + 1] into region_order; a chunk has one region
//   lambda, x       [3 num_nodes, num_columns] mm
//   parts           [num_chunks, num_columns], entries of the work item's own; summed by the host
static inline tensor3 displacement_gradient(global const int* nodes, const element_shape* shape,
                                            global const real* x, size_t num_columns,
                                            size_t column) {
    tensor3 h;
#pragma unroll
    for (int i = 0; i < 9; ++i) h.m[i] = (columns)(0);
#pragma unroll
    for (int a = 0; a < NODES_PER_ELEMENT; ++a) {
        global const real* at = x + (size_t)3 * nodes[a] * num_columns + column;
        vector3 u;
#pragma unroll
        for (int c = 0; c < 3; ++c) u.c[c] = LOAD_COLUMNS(at + c * num_columns);
        add_outer(&h, &u, shape->gradient[a]);
    }
    return h;
}

PALPATE_KERNEL void parameter_gradient(global const int* elements, global const int* region,
                                       global const real* geometry, global const real* unit_moduli,
                                       global const int* region_order,
                                       global const int* chunk_start, global const real* lambda,
                                       global const real* x, global wide* parts, int num_chunks,
                                       int num_columns, int first_column) {
    const size_t chunk = get_global_id(1);
    const size_t column = column_of_item(first_column);
    if (chunk >= (size_t)num_chunks || column >= (size_t)num_columns) return;

    wide_columns sum = (wide_columns)(0);
    for (int k = chunk_start[chunk]; k < chunk_start[chunk + 1]; ++k) {
        const size_t element = region_order[k];
        global const int* nodes = elements + NODES_PER_ELEMENT * element;
        const element_shape shape = load_element(geometry, element);
        const material law = load_material(unit_moduli, region[element]);
        const tensor3 a = displacement_gradient(nodes, &shape, lambda, num_columns, column);
        const tensor3 b = displacement_gradient(nodes, &shape, x, num_columns, column);
        sum += WIDEN_COLUMNS(shape.volume * material_energy_product(&law, &a, &b));
    }
    STORE_WIDE_COLUMNS(sum, parts + chunk * num_columns + column);
}

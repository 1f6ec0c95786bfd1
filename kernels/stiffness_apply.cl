// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Matrix-free product, element half: f_a = E V stress(grad u) grad N_a for the nodes a of an
// element. One work item: one element, COLUMN_WIDTH columns.
//   elements     [num_elements, 4] node numbers
//   region       [num_elements]
//   geometry     [num_elements, ELEMENT_REALS]; if RECOMPUTED the nodes [num_nodes, 3] mm instead
//   unit_moduli  [num_materials, 2]
//   stiffness    [num_materials] kPa
//   prescribed   [3 num_nodes] 1 where the displacement is given: read as zero if CONSTRAINED
//   x            [3 num_nodes, num_columns] mm
//   forces       [num_elements, 4, 3, num_pass_columns] mN, slots of the element's own work items
// Defines: CONSTRAINED 0 or 1; RECOMPUTED 1: gradients and volume from the node positions, which
// saves reading them and costs arithmetic.
#if !defined(CONSTRAINED) || !defined(RECOMPUTED)
#error "CONSTRAINED and RECOMPUTED must be defined"
#endif

static inline vector3 load_node(global const real* x, global const uchar* prescribed, size_t node,
                                size_t num_columns, size_t column) {
    vector3 u;
#pragma unroll
    for (int c = 0; c < 3; ++c) {
        const size_t dof = 3 * node + c;
        u.c[c] = LOAD_COLUMNS(x + dof * num_columns + column);
#if CONSTRAINED
        if (prescribed[dof]) u.c[c] = (columns)(0);
#endif
    }
    return u;
}

PALPATE_KERNEL void stiffness_apply(global const int* elements, global const int* region,
                                    global const real* geometry, global const real* unit_moduli,
                                    global const real* stiffness, global const uchar* prescribed,
                                    global const real* x, global real* forces, int num_elements,
                                    int num_columns, int first_column, int num_pass_columns) {
    const size_t element = get_global_id(1);
    const size_t pass_column = column_of_item(0);
    if (element >= (size_t)num_elements || pass_column >= (size_t)num_pass_columns) return;

#if RECOMPUTED
    const element_shape shape = shape_of_nodes(geometry, elements + NODES_PER_ELEMENT * element);
#else
    const element_shape shape = load_element(geometry, element);
#endif
    tensor3 h;
#pragma unroll
    for (int i = 0; i < 9; ++i) h.m[i] = (columns)(0);
#pragma unroll
    for (int a = 0; a < NODES_PER_ELEMENT; ++a) {
        const size_t node = elements[NODES_PER_ELEMENT * element + a];
        const vector3 u =
            load_node(x, prescribed, node, num_columns, (size_t)first_column + pass_column);
        add_outer(&h, &u, shape.gradient[a]);
    }

    const material law = load_material(unit_moduli, region[element]);
    const tensor3 stress = material_stress(&law, &h);
    const real scale = stiffness[region[element]] * shape.volume;
#pragma unroll
    for (int a = 0; a < NODES_PER_ELEMENT; ++a) {
        const vector3 f = tensor_times(&stress, shape.gradient[a]);
#pragma unroll
        for (int c = 0; c < 3; ++c) {
            const size_t slot = 3 * (NODES_PER_ELEMENT * element + a) + c;
            STORE_COLUMNS(scale * f.c[c], forces + slot * num_pass_columns + pass_column);
        }
    }
}

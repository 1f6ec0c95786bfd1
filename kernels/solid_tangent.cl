// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Stiffness blocks of elements at large deformation, K_ab = sum over points of V dH/du_a A dH/du_b
// with the moduli A = dP/dH. One work item: one element of the law, which alone writes its blocks.
// Elements with a point that is not valid add nothing.
//   blocks  [num_elements, NODES_PER_ELEMENT, NODES_PER_ELEMENT, 9] mN/mm, row by row
// Other buffers as in solid_force.cl. COLUMN_WIDTH: how many entries of H are changed at a time.

// dP by entry c of H at 9 c.
static inline void moduli_of(const material_law* law, const law_state* s, real* moduli) {
    real lanes[COLUMN_WIDTH];
    for (int first = 0; first < 9; first += COLUMN_WIDTH) {
        tensor3 units;
        for (int r = 0; r < 9; ++r) {
            for (int k = 0; k < COLUMN_WIDTH; ++k) lanes[k] = first + k == r ? 1 : 0;
            units.m[r] = LOAD_COLUMNS(lanes);
        }
        const tensor3 changes = law_tangent_apply(law, s, &units);
        for (int r = 0; r < 9; ++r) {
            STORE_COLUMNS(changes.m[r], lanes);
            for (int k = 0; k < COLUMN_WIDTH && first + k < 9; ++k)
                moduli[9 * (first + k) + r] = lanes[k];
        }
    }
}

// dP by component j of node b, from the moduli: [9, 9], dP by entry c of H at 9 c.
static inline void stress_by_node(const real* moduli, global const real* point, int b, int j,
                                  real* stress) {
    global const real* gradient = point + 3 * b;
    for (int r = 0; r < 9; ++r)
        stress[r] = moduli[27 * j + r] * gradient[0] + moduli[27 * j + 9 + r] * gradient[1] +
                    moduli[27 * j + 18 + r] * gradient[2];
#if HAS_HOOP
    if (j == 0)
        for (int r = 0; r < 9; ++r) stress[r] += moduli[72 + r] * point[HOOP_AT + b];
#endif
}

PALPATE_KERNEL void solid_tangent(global const real* coefficients, global const int* list,
                                  int num_items, global const int* elements,
                                  global const int* region, global const real* points,
                                  global const real* u, global real* blocks) {
    const size_t item = get_global_id(1);
    if (item >= (size_t)num_items) return;

    const size_t element = list[item];
    global const int* nodes = elements + NODES_PER_ELEMENT * element;
    const material_law law = load_law(coefficients, region[element]);
    global real* own = blocks + 9 * NODES_PER_ELEMENT * NODES_PER_ELEMENT * element;
    int is_valid = 1;
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = point_of(points, element, q);
        const law_state s = state_at(&law, nodes, point, u);
        is_valid = is_valid && s.is_valid;
        real moduli[81];
        moduli_of(&law, &s, moduli);
        for (int b = 0; b < NODES_PER_ELEMENT; ++b)
            for (int j = 0; j < 3; ++j) {
                real stress[9];
                stress_by_node(moduli, point, b, j, stress);
                for (int a = 0; a < NODES_PER_ELEMENT; ++a)
                    for (int i = 0; i < 3; ++i) {
                        const int at = 9 * (NODES_PER_ELEMENT * a + b) + 3 * i + j;
                        const real share = force_on(stress, point, a, i);
                        own[at] = q == 0 ? share : own[at] + share;
                    }
            }
    }
    for (int k = 0; k < 9 * NODES_PER_ELEMENT * NODES_PER_ELEMENT; ++k)
        if (!is_valid) own[k] = 0;
}

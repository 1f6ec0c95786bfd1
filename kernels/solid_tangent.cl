// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Stiffness blocks of elements at large deformation, K_ab = sum over points of V dH/du_a A dH/du_b
// with the moduli A = dP/dH. One work item: one element of the law, which alone writes its blocks.
// Elements with a point that is not valid add nothing.
//   blocks  [num_elements, NODES_PER_ELEMENT, NODES_PER_ELEMENT, 9] mN/mm, row by row
// Other buffers as in solid_force.cl. COLUMN_WIDTH: how many entries of H are changed at a time.

// dP by entry c of H at 9 c.
static inline void moduli_of(const material_law* law, const element_mean* mean,
                             const point_response* r, real* moduli) {
    columns pressure_change;
    real lanes[COLUMN_WIDTH];
    for (int first = 0; first < 9; first += COLUMN_WIDTH) {
        tensor3 units;
        for (int i = 0; i < 9; ++i) {
            for (int k = 0; k < COLUMN_WIDTH; ++k) lanes[k] = first + k == i ? 1 : 0;
            units.m[i] = LOAD_COLUMNS(lanes);
        }
        const tensor3 changes =
            response_change(law, mean, r, &units, (columns)(0), &pressure_change);
        for (int i = 0; i < 9; ++i) {
            STORE_COLUMNS(changes.m[i], lanes);
            for (int k = 0; k < COLUMN_WIDTH && first + k < 9; ++k)
                moduli[9 * (first + k) + i] = lanes[k];
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
    const element_mean mean = mean_of_element(&law, nodes, point_of(points, element, 0), u);
    int is_valid = mean.is_valid;
#if HAS_MEAN_VOLUME
    // c = V dtheta/du, b = df/dtheta, and dpi/dtheta, theta being the element's
    real c[3 * NODES_PER_ELEMENT], b[3 * NODES_PER_ELEMENT];
    real curvature = 0;
    for (int k = 0; k < 3 * NODES_PER_ELEMENT; ++k) c[k] = b[k] = 0;
#endif
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = point_of(points, element, q);
        const point_response r = response_at(&law, &mean, nodes, point, u);
        is_valid = is_valid && r.state.is_valid;
#if HAS_MEAN_VOLUME
        tensor3 none;
        columns change;
        real lanes[COLUMN_WIDTH], slope[9], by_theta[9];
        for (int i = 0; i < 9; ++i) none.m[i] = (columns)(0);
        const tensor3 stress_change =
            response_change(&law, &mean, &r, &none, (columns)(1), &change);
        for (int i = 0; i < 9; ++i) {
            STORE_COLUMNS(stress_change.m[i], lanes);
            by_theta[i] = lanes[0];
            slope[i] = volume_slope(&r, i);
        }
        STORE_COLUMNS(change, lanes);
        curvature += point[VOLUME_AT] / mean.volume * lanes[0];
        for (int a = 0; a < NODES_PER_ELEMENT; ++a)
            for (int i = 0; i < 3; ++i) {
                c[3 * a + i] += force_on(slope, point, a, i);
                b[3 * a + i] += force_on(by_theta, point, a, i);
            }
#endif
        real moduli[81];
        moduli_of(&law, &mean, &r, moduli);
        for (int node = 0; node < NODES_PER_ELEMENT; ++node)
            for (int j = 0; j < 3; ++j) {
                real stress[9];
                stress_by_node(moduli, point, node, j, stress);
                for (int a = 0; a < NODES_PER_ELEMENT; ++a)
                    for (int i = 0; i < 3; ++i) {
                        const int at = 9 * (NODES_PER_ELEMENT * a + node) + 3 * i + j;
                        const real share = force_on(stress, point, a, i);
                        own[at] = q == 0 ? share : own[at] + share;
                    }
            }
    }
#if HAS_MEAN_VOLUME
    for (int row = 0; row < 3 * NODES_PER_ELEMENT; ++row)
        for (int column = 0; column < 3 * NODES_PER_ELEMENT; ++column)
            // (b c^T + c b^T + dpi/dtheta c c^T) / V
            own[9 * (NODES_PER_ELEMENT * (row / 3) + column / 3) + 3 * (row % 3) + column % 3] +=
                (b[row] * c[column] + c[row] * b[column] + curvature * c[row] * c[column]) /
                mean.volume;
#endif
    for (int k = 0; k < 9 * NODES_PER_ELEMENT * NODES_PER_ELEMENT; ++k)
        if (!is_valid) own[k] = 0;
}

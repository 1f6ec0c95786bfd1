// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Energy and forces of elements at large deformation, f_a = sum over points of V P dH/du_a. One
// work item: one element of the law, which alone writes the element's slots.
//   coefficients  [num_materials, LAW_COEFFICIENTS], see the law
//   list          [num_items] the elements of this law
//   elements      [num_elements, NODES_PER_ELEMENT]
//   region        [num_elements]
//   points        [num_elements, POINTS_PER_ELEMENT, REALS_PER_POINT], see solid_element.cl
//   u             [3 num_nodes] mm
//   energy        [num_elements] mN mm, infinite where a point is not valid: then without forces
//   forces        [num_elements, NODES_PER_ELEMENT, 3] mN
PALPATE_KERNEL void solid_force(global const real* coefficients, global const int* list,
                                int num_items, global const int* elements, global const int* region,
                                global const real* points, global const real* u,
                                global real* energy, global real* forces) {
    const size_t item = get_global_id(1);
    if (item >= (size_t)num_items) return;

    const size_t element = list[item];
    global const int* nodes = elements + NODES_PER_ELEMENT * element;
    const material_law law = load_law(coefficients, region[element]);
    real stored = 0;
    real force[3 * NODES_PER_ELEMENT];
    for (int k = 0; k < 3 * NODES_PER_ELEMENT; ++k) force[k] = 0;
    const element_mean mean = mean_of_element(&law, nodes, point_of(points, element, 0), u);
    int is_valid = mean.is_valid;
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = point_of(points, element, q);
        const point_response r = response_at(&law, &mean, nodes, point, u);
        is_valid = is_valid && r.state.is_valid;
        real p[9];
        response_stress(&law, &mean, &r, p);
        stored += point[VOLUME_AT] * law_energy(&law, &r.state);
        for (int a = 0; a < NODES_PER_ELEMENT; ++a)
            for (int i = 0; i < 3; ++i) force[3 * a + i] += force_on(p, point, a, i);
    }
    energy[element] = is_valid ? stored : (real)INFINITY;
    for (int k = 0; k < 3 * NODES_PER_ELEMENT; ++k)
        forces[3 * NODES_PER_ELEMENT * element + k] = is_valid ? force[k] : (real)0;
}

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// lambda . df/dp of every element for the parameters p of its law: sum over points of
// V dP/dp : grad lambda. One work item: one element of the law, which alone writes its parts.
//   u, lambda  [3 num_nodes] mm
//   parts      [num_elements, stride] mN mm per unit of the parameter, the first LAW_PARAMETERS of
//              each row; zero where a point is not valid
// Other buffers as in solid_force.cl.
PALPATE_KERNEL void solid_parameters(global const real* coefficients, global const int* list,
                                     int num_items, global const int* elements,
                                     global const int* region, global const real* points,
                                     global const real* u, global const real* lambda,
                                     global real* parts, int stride) {
    const size_t item = get_global_id(1);
    if (item >= (size_t)num_items) return;

    const size_t element = list[item];
    global const int* nodes = elements + NODES_PER_ELEMENT * element;
    const material_law law = load_law(coefficients, region[element]);
    real sums[LAW_PARAMETERS];
    for (int k = 0; k < LAW_PARAMETERS; ++k) sums[k] = 0;
    const element_mean mean = mean_of_element(&law, nodes, point_of(points, element, 0), u);
    int is_valid = mean.is_valid;
#if HAS_MEAN_VOLUME
    real theta_change = 0;  // along lambda
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = point_of(points, element, q);
        real slope[9], direction[9];
        volume_slope_at(nodes, point, u, slope);
        state_gradient(nodes, point, lambda, direction);
        for (int i = 0; i < 9; ++i)
            theta_change += point[VOLUME_AT] / mean.volume * slope[i] * direction[i];
    }
#endif
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = point_of(points, element, q);
        const point_response r = response_at(&law, &mean, nodes, point, u);
        is_valid = is_valid && r.state.is_valid;
        real slope[9];
        state_gradient(nodes, point, lambda, slope);
#if HAS_MEAN_VOLUME
        tensor3 dh;
        real lanes[COLUMN_WIDTH];
        for (int i = 0; i < 9; ++i) dh.m[i] = (columns)(slope[i]);
        dh = response_direction(&mean, &r, &dh, (columns)(theta_change));
        for (int i = 0; i < 9; ++i) {
            STORE_COLUMNS(dh.m[i], lanes);
            slope[i] = lanes[0];
        }
#endif
        for (int k = 0; k < LAW_PARAMETERS; ++k) {
            real p[9];
            law_parameter_stress(&law, &r.state, k, p);
            real work = 0;
            for (int i = 0; i < 9; ++i) work += p[i] * slope[i];
            sums[k] += point[VOLUME_AT] * work;
        }
    }
    for (int k = 0; k < LAW_PARAMETERS; ++k)
        parts[(size_t)stride * element + k] = is_valid ? sums[k] : (real)0;
}

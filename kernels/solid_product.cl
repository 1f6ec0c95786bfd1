// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Matrix-free product with the stiffness at large deformation, element half: the forces of the
// changes of stress that the directions x give rise to at the state u. One work item: one element
// of the law, COLUMN_WIDTH columns.
//   u       [3 num_nodes] mm, the state
//   x       [3 num_nodes, num_columns] mm
//   forces  [num_elements, NODES_PER_ELEMENT, 3, num_pass_columns] mN, slots of the work item's
//   own; zero
//           where a point is not valid
// Other buffers as in solid_force.cl; gather_to_nodes.cl is the other half.
PALPATE_KERNEL void solid_product(global const real* coefficients, global const int* list,
                                  int num_items, global const int* elements,
                                  global const int* region, global const real* points,
                                  global const real* u, global const real* x, global real* forces,
                                  int num_columns, int first_column, int num_pass_columns) {
    const size_t item = get_global_id(1);
    const size_t pass_column = column_of_item(0);
    if (item >= (size_t)num_items || pass_column >= (size_t)num_pass_columns) return;

    const size_t element = list[item];
    global const int* nodes = elements + NODES_PER_ELEMENT * element;
    const material_law law = load_law(coefficients, region[element]);
    vector3 force[NODES_PER_ELEMENT];
    for (int a = 0; a < NODES_PER_ELEMENT; ++a)
        for (int i = 0; i < 3; ++i) force[a].c[i] = (columns)(0);
    const element_mean mean = mean_of_element(&law, nodes, point_of(points, element, 0), u);
    const size_t column = (size_t)first_column + pass_column;
    int is_valid = mean.is_valid;
    columns theta_change = (columns)(0), pressure_change;
#if HAS_MEAN_VOLUME
    // dtheta = (1/V) sum volume dJ/dH : dH
    columns mean_change = (columns)(0);
    real slope_force[3 * NODES_PER_ELEMENT];
    for (int k = 0; k < 3 * NODES_PER_ELEMENT; ++k) slope_force[k] = 0;
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = point_of(points, element, q);
        const tensor3 dh = direction_gradient(nodes, point, x, num_columns, column);
        real slope[9];
        volume_slope_at(nodes, point, u, slope);
        for (int i = 0; i < 9; ++i)
            theta_change += point[VOLUME_AT] / mean.volume * slope[i] * dh.m[i];
        for (int a = 0; a < NODES_PER_ELEMENT; ++a)
            for (int i = 0; i < 3; ++i) slope_force[3 * a + i] += force_on(slope, point, a, i);
    }
#endif
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = point_of(points, element, q);
        const point_response r = response_at(&law, &mean, nodes, point, u);
        is_valid = is_valid && r.state.is_valid;
        const tensor3 dh = direction_gradient(nodes, point, x, num_columns, column);
        const tensor3 dp = response_change(&law, &mean, &r, &dh, theta_change, &pressure_change);
#if HAS_MEAN_VOLUME
        mean_change += point[VOLUME_AT] / mean.volume * pressure_change;
#endif
        const real volume = point[VOLUME_AT];
        for (int a = 0; a < NODES_PER_ELEMENT; ++a) {
            for (int i = 0; i < 3; ++i)
                force[a].c[i] +=
                    volume * (dp.m[3 * i] * point[3 * a] + dp.m[3 * i + 1] * point[3 * a + 1] +
                              dp.m[3 * i + 2] * point[3 * a + 2]);
#if HAS_HOOP
            force[a].c[0] += volume * point[HOOP_AT + a] * dp.m[8];
#endif
        }
    }
#if HAS_MEAN_VOLUME
    // dpi c
    for (int a = 0; a < NODES_PER_ELEMENT; ++a)
        for (int i = 0; i < 3; ++i) force[a].c[i] += mean_change * slope_force[3 * a + i];
#endif
    for (int a = 0; a < NODES_PER_ELEMENT; ++a)
        for (int i = 0; i < 3; ++i) {
            const size_t slot = 3 * (NODES_PER_ELEMENT * element + a) + i;
            const columns value = is_valid ? force[a].c[i] : (columns)(0);
            STORE_COLUMNS(value, forces + slot * num_pass_columns + pass_column);
        }
}

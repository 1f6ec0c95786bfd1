// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Material laws at points without a mesh. One work item: one point, COLUMN_WIDTH directions; the
// items of the first columns write what has no column, so no two write to one place.
//   coefficients  [num_materials, LAW_COEFFICIENTS], see the law
//   region        [num_points] the material of each point
//   gradients     [num_points, 9] H = F - I
//   directions    [num_points, 9, num_columns] dF
//   energy        [num_points] kPa, infinite where the state is not valid
//   stress        [num_points, 9] P, kPa
//   tangent       [num_points, 9, num_columns] dP, kPa
static inline law_state state_of_point(const material_law* l, global const real* gradients,
                                       size_t point) {
    real h[9];
    for (int i = 0; i < 9; ++i) h[i] = gradients[9 * point + i];
    return state_of_law(l, h);
}

PALPATE_KERNEL void material_point(global const real* coefficients, global const int* region,
                                   global const real* gradients, global const real* directions,
                                   global real* energy, global real* stress, global real* tangent,
                                   int num_points, int num_columns) {
    const size_t point = get_global_id(1);
    const size_t column = column_of_item(0);
    if (point >= (size_t)num_points || column >= (size_t)num_columns) return;

    const material_law l = load_law(coefficients, region[point]);
    const law_state s = state_of_point(&l, gradients, point);
    if (column == 0) {
        real p[9];
        law_stress(&l, &s, p);
        for (int i = 0; i < 9; ++i) stress[9 * point + i] = p[i];
        energy[point] = law_energy(&l, &s);
    }

    tensor3 df;
    for (int i = 0; i < 9; ++i)
        df.m[i] = LOAD_COLUMNS(directions + (9 * point + i) * num_columns + column);
    const tensor3 dp = law_tangent_apply(&l, &s, &df);
    for (int i = 0; i < 9; ++i)
        STORE_COLUMNS(dp.m[i], tangent + (9 * point + i) * num_columns + column);
}

// Derivatives by each parameter. One work item: one point.
//   energy  [num_points, LAW_PARAMETERS], stress [num_points, LAW_PARAMETERS, 9], in kPa per unit
//   of the parameter
PALPATE_KERNEL void material_point_parameters(global const real* coefficients,
                                              global const int* region,
                                              global const real* gradients, global real* energy,
                                              global real* stress, int num_points) {
    const size_t point = get_global_id(1);
    if (point >= (size_t)num_points || get_global_id(0) > 0) return;

    const material_law l = load_law(coefficients, region[point]);
    const law_state s = state_of_point(&l, gradients, point);
    for (int k = 0; k < LAW_PARAMETERS; ++k) {
        const size_t row = LAW_PARAMETERS * point + k;
        real p[9];
        law_parameter_stress(&l, &s, k, p);
        for (int i = 0; i < 9; ++i) stress[9 * row + i] = p[i];
        energy[row] = law_parameter_energy(&l, &s, k);
    }
}

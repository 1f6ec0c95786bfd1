// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Reduced polynomial of second order, W = C1 x + C2 x^2 + (J - 1)^2 / D1.
// LAW_COEFFICIENTS numbers per material, kPa: C1, C2, kappa = 2 / D1, its derivative by D1.
#define LAW_COEFFICIENTS 4
#define LAW_PARAMETERS 3

typedef struct {
    real c1;
    real c2;
    real kappa;
    real kappa_slope;
} material_law;

static inline material_law load_law(global const real* coefficients, int region) {
    global const real* c = coefficients + LAW_COEFFICIENTS * region;
    const material_law l = {c[0], c[1], c[2], c[3]};
    return l;
}

static inline response law_response(const material_law* l, const finite_strain* s) {
    const real x = distortion(s);
    return reduced_response(s, x, x * (l->c1 + l->c2 * x), l->c1 + 2 * l->c2 * x, 2 * l->c2,
                            l->kappa);
}

static inline parameter_response law_parameter_response(const material_law* l,
                                                        const finite_strain* s, int k) {
    const real x = distortion(s);
    if (k == 0) return reduced_parameter_response(s, x, x, 1, 0);
    if (k == 1) return reduced_parameter_response(s, x, x * x, 2 * x, 0);
    return reduced_parameter_response(s, x, 0, 0, l->kappa_slope);
}

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Law of Yeoh (1993) in reduced invariants, W = C1 x + C2 x^2 + C3 x^3 + kappa/2 (J - 1)^2.
// LAW_COEFFICIENTS numbers per material, kPa: C1, C2, C3, kappa.
#define LAW_COEFFICIENTS 4
#define LAW_PARAMETERS 4

typedef struct {
    real c1;
    real c2;
    real c3;
    real kappa;
} material_law;

static inline material_law load_law(global const real* coefficients, int region) {
    global const real* c = coefficients + LAW_COEFFICIENTS * region;
    const material_law l = {c[0], c[1], c[2], c[3]};
    return l;
}

static inline response law_response(const material_law* l, const finite_strain* s) {
    const real x = distortion(s);
    return reduced_response(s, x, x * (l->c1 + x * (l->c2 + x * l->c3)),
                            l->c1 + x * (2 * l->c2 + 3 * x * l->c3), 2 * l->c2 + 6 * x * l->c3,
                            l->kappa);
}

static inline parameter_response law_parameter_response(const material_law* l,
                                                        const finite_strain* s, int k) {
    const real x = distortion(s);
    if (k == 0) return reduced_parameter_response(s, x, x, 1, 0);
    if (k == 1) return reduced_parameter_response(s, x, x * x, 2 * x, 0);
    if (k == 2) return reduced_parameter_response(s, x, x * x * x, 3 * x * x, 0);
    return reduced_parameter_response(s, x, 0, 0, 1);
}

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Neo-Hookean law in reduced invariants, W = mu x + kappa/2 (J - 1)^2.
// LAW_COEFFICIENTS numbers per material, kPa: mu, kappa.
#define LAW_COEFFICIENTS 2
#define LAW_PARAMETERS 2

typedef struct {
    real mu;
    real kappa;
} material_law;

static inline material_law load_law(global const real* coefficients, int region) {
    global const real* c = coefficients + LAW_COEFFICIENTS * region;
    const material_law l = {c[0], c[1]};
    return l;
}

static inline response law_response(const material_law* l, const finite_strain* s) {
    const real x = distortion(s);
    return reduced_response(s, x, l->mu * x, l->mu, 0, l->kappa);
}

static inline parameter_response law_parameter_response(const material_law* l,
                                                        const finite_strain* s, int k) {
    const real x = distortion(s);
    return k == 0 ? reduced_parameter_response(s, x, x, 1, 0)
                  : reduced_parameter_response(s, x, 0, 0, 1);
}

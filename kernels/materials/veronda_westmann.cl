// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Exponential law of the type of Veronda and Westmann (1970) in reduced invariants,
//   W = mu/gamma (exp(gamma x) - 1) + kappa/2 (J - 1)^2.
// LAW_COEFFICIENTS numbers per material: mu (kPa), gamma (1), kappa (kPa).
#define LAW_COEFFICIENTS 3
#define LAW_PARAMETERS 3

typedef struct {
    real mu;
    real gamma;
    real kappa;
} material_law;

static inline material_law load_law(global const real* coefficients, int region) {
    global const real* c = coefficients + LAW_COEFFICIENTS * region;
    const material_law l = {c[0], c[1], c[2]};
    return l;
}

// (y e^y - e^y + 1) / y^2, by its series sum y^k / (k! (k + 2)) where the difference cancels.
static inline real exponential_moment(real y) {
    real series = 0;
    for (int k = 14; k > 0; --k) series = (series + (real)1 / (k + 2)) * y / k;
    return fabs(y) < (real)0.5f ? series + (real)0.5f : (y * exp(y) - expm1(y)) / (y * y);
}

static inline response law_response(const material_law* l, const finite_strain* s) {
    const real x = distortion(s);
    const real growth = expm1(l->gamma * x);
    const real first = l->mu * (1 + growth);
    return reduced_response(s, x, l->mu / l->gamma * growth, first, l->gamma * first, l->kappa);
}

static inline parameter_response law_parameter_response(const material_law* l,
                                                        const finite_strain* s, int k) {
    const real x = distortion(s);
    const real growth = expm1(l->gamma * x);
    if (k == 0) return reduced_parameter_response(s, x, growth / l->gamma, 1 + growth, 0);
    if (k == 1)
        return reduced_parameter_response(s, x, l->mu * x * x * exponential_moment(l->gamma * x),
                                          l->mu * x * (1 + growth), 0);
    return reduced_parameter_response(s, x, 0, 0, 1);
}

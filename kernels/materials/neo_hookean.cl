// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Compressible neo-Hookean law, W = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2.
// LAW_COEFFICIENTS numbers per material, kPa: mu, lambda, their derivatives by stiffness and by
// Poisson's ratio: mu', mu', lambda', lambda'.
#define LAW_COEFFICIENTS 6
#define LAW_PARAMETERS 2

typedef struct {
    real mu;
    real lambda;
    real mu_slope[2];
    real lambda_slope[2];
} material_law;

static inline material_law load_law(global const real* coefficients, int region) {
    global const real* c = coefficients + LAW_COEFFICIENTS * region;
    const material_law l = {c[0], c[1], {c[2], c[3]}, {c[4], c[5]}};
    return l;
}

static inline parameter_response response_of_moduli(const finite_strain* s, real mu, real lambda) {
    const real distortion_energy = 3 * minus_log1p(2 * s->mean) - s->log_distortion;
    parameter_response r;
    r.energy = mu / 2 * distortion_energy + lambda / 2 * s->log_volume * s->log_volume;
    r.shear = mu;
    r.pressure = 2 * mu * s->mean + lambda * s->log_volume;
    return r;
}

static inline response law_response(const material_law* l, const finite_strain* s) {
    const parameter_response p = response_of_moduli(s, l->mu, l->lambda);
    const response r = {p.energy, p.shear, 0, 0, p.pressure, l->lambda, 2 * l->mu};
    return r;
}

static inline parameter_response law_parameter_response(const material_law* l,
                                                        const finite_strain* s, int k) {
    return response_of_moduli(s, l->mu_slope[k], l->lambda_slope[k]);
}

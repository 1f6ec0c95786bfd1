// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Isotropic linear elasticity. With the strain e = sym(grad u):
//   stress = E (lambda tr(e) I + 2 mu e),  lambda and mu for E = 1 (no unit)
// `unit_moduli` is [num_materials, 2]: lambda, mu.
typedef struct {
    real lambda;
    real mu;
} material;

static inline material load_material(global const real* unit_moduli, int region) {
    material m;
    m.lambda = unit_moduli[2 * region];
    m.mu = unit_moduli[2 * region + 1];
    return m;
}

// Stress per unit modulus of the displacement gradient h.
static inline tensor3 material_stress(const material* law, const tensor3* h) {
    const tensor3 strain = symmetric_part(h);
    const columns pressure = law->lambda * trace(&strain);
    tensor3 stress;
#pragma unroll
    for (int i = 0; i < 9; ++i) stress.m[i] = (2 * law->mu) * strain.m[i];
    stress.m[0] += pressure;
    stress.m[4] += pressure;
    stress.m[8] += pressure;
    return stress;
}

// strain(a) : stress(b) per unit modulus; twice the energy density if a == b.
static inline columns material_energy_product(const material* law, const tensor3* a,
                                              const tensor3* b) {
    const tensor3 strain_a = symmetric_part(a);
    const tensor3 strain_b = symmetric_part(b);
    return law->lambda * trace(&strain_a) * trace(&strain_b) +
           (2 * law->mu) * double_dot(&strain_a, &strain_b);
}

// block += scale * (lambda g h^T + mu h g^T + mu (g . h) I): force at the node with shape gradient
// g by a displacement of the node with shape gradient h, per unit modulus and volume.
static inline void add_material_block(const material* law, const real* g, const real* h, real scale,
                                      real* block) {
    const real shear = scale * law->mu;
    const real bulk = scale * law->lambda;
    const real diagonal = shear * (g[0] * h[0] + g[1] * h[1] + g[2] * h[2]);
#pragma unroll
    for (int i = 0; i < 3; ++i) {
#pragma unroll
        for (int j = 0; j < 3; ++j) block[3 * i + j] += bulk * g[i] * h[j] + shear * h[i] * g[j];
        block[4 * i] += diagonal;
    }
}

// The same law as one of the laws of large deformation, with the fixed names that
// finite_strain_law.cl has for the others. LAW_COEFFICIENTS numbers per material, kPa: mu, lambda,
// their derivatives by stiffness and by Poisson's ratio: mu', mu', lambda', lambda'.
#define LAW_COEFFICIENTS 6
#define LAW_PARAMETERS 2
#define LAW_IS_SMALL_STRAIN 1

typedef struct {
    real mu;
    real lambda;
    real mu_slope[2];
    real lambda_slope[2];
} material_law;

typedef struct {
    real twice_strain[9];  // H + H^T
    int is_valid;          // 0 only for numbers that are not finite
} law_state;

static inline material_law load_law(global const real* coefficients, int region) {
    global const real* c = coefficients + LAW_COEFFICIENTS * region;
    const material_law l = {c[0], c[1], {c[2], c[3]}, {c[4], c[5]}};
    return l;
}

static inline law_state state_of_law(const material_law* l, const real* h) {
    law_state s;
    real size = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            s.twice_strain[3 * i + j] = h[3 * i + j] + h[3 * j + i];
            size += fabs(s.twice_strain[3 * i + j]);
        }
    s.is_valid = size < (real)1e10f;
    for (int i = 0; i < 9; ++i) s.twice_strain[i] = s.is_valid ? s.twice_strain[i] : (real)0;
    return s;
}

static inline void linear_stress(real mu, real lambda, const real* twice_strain, real* stress) {
    const real pressure = lambda / 2 * (twice_strain[0] + twice_strain[4] + twice_strain[8]);
    for (int i = 0; i < 9; ++i) stress[i] = mu * twice_strain[i];
    for (int i = 0; i < 9; i += 4) stress[i] += pressure;
}

static inline real linear_energy(real mu, real lambda, const real* twice_strain) {
    real stress[9];
    linear_stress(mu, lambda, twice_strain, stress);
    real sum = 0;
    for (int i = 0; i < 9; ++i) sum += stress[i] * twice_strain[i];
    return sum / 4;
}

static inline real law_energy(const material_law* l, const law_state* s) {
    return s->is_valid ? linear_energy(l->mu, l->lambda, s->twice_strain) : (real)INFINITY;
}

static inline void law_stress(const material_law* l, const law_state* s, real* stress) {
    linear_stress(l->mu, l->lambda, s->twice_strain, stress);
}

static inline tensor3 law_tangent_apply(const material_law* l, const law_state* s,
                                        const tensor3* df) {
    const tensor3 strain = symmetric_part(df);
    const columns pressure = l->lambda * trace(&strain);
    tensor3 dp;
    for (int i = 0; i < 9; ++i) dp.m[i] = (2 * l->mu) * strain.m[i];
    for (int i = 0; i < 9; i += 4) dp.m[i] += pressure;
    for (int i = 0; i < 9; ++i) dp.m[i] = s->is_valid ? dp.m[i] : (columns)(0);
    return dp;
}

static inline real law_parameter_energy(const material_law* l, const law_state* s, int k) {
    return linear_energy(l->mu_slope[k], l->lambda_slope[k], s->twice_strain);
}

static inline void law_parameter_stress(const material_law* l, const law_state* s, int k,
                                        real* stress) {
    linear_stress(l->mu_slope[k], l->lambda_slope[k], s->twice_strain, stress);
}

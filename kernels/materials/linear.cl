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

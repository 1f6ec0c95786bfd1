// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// From the response of a law to energy, stress and tangent, the same for every law before it. A
// state is one point; directions have COLUMN_WIDTH columns. Not valid: see `is_valid`; the energy
// is infinite then, the rest zero.
#define LAW_IS_SMALL_STRAIN 0

typedef struct {
    finite_strain strain;
    response values;
    int is_valid;
} law_state;

// F^-T (shear 2 e + pressure I)
static inline void mandel_to_piola(const finite_strain* s, real shear, real pressure, real* p) {
    const real* g = s->inverse_transposed;
    const real* e = s->twice_deviator;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            p[3 * i + j] =
                shear * (g[3 * i] * e[j] + g[3 * i + 1] * e[3 + j] + g[3 * i + 2] * e[6 + j]) +
                pressure * g[3 * i + j];
}

static inline law_state state_of_law(const material_law* l, const real* h) {
    law_state s;
    s.strain = finite_strain_of(h);
    s.values = law_response(l, &s.strain);
    real p[9];
    mandel_to_piola(&s.strain, s.values.shear, s.values.pressure, p);
    real size = 0;
    for (int i = 0; i < 9; ++i) size += fabs(p[i]);
    s.is_valid = s.strain.is_valid && size < LARGEST_STRESS_KPA;  // 0 for NaN
    if (!s.is_valid) {
        const response none = {(real)INFINITY, 0, 0, 0, 0, 0, 0};
        s.values = none;
    }
    return s;
}

static inline real law_energy(const material_law* l, const law_state* s) {
    return s->values.energy;
}

// First Piola stress, kPa.
static inline void law_stress(const material_law* l, const law_state* s, real* stress) {
    mandel_to_piola(&s->strain, s->values.shear, s->values.pressure, stress);
}

// dP = F^-T (d(F^T P) - M^T F^T P), M = F^-1 dF.
static inline tensor3 law_tangent_apply(const material_law* l, const law_state* s,
                                        const tensor3* df) {
    const real* f = s->strain.f;
    const real* g = s->strain.inverse_transposed;
    const real* e = s->strain.twice_deviator;
    const response* r = &s->values;
    tensor3 m, ft_df;
    columns distortion_rate = (columns)(0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int ij = 3 * i + j;
            m.m[ij] = g[i] * df->m[j] + g[3 + i] * df->m[3 + j] + g[6 + i] * df->m[6 + j];
            ft_df.m[ij] = f[i] * df->m[j] + f[3 + i] * df->m[3 + j] + f[6 + i] * df->m[6 + j];
            distortion_rate += e[ij] * m.m[ij];
        }
    const columns volume_rate = trace(&m);
    const columns mean_rate = trace(&ft_df) / 3;
    const columns d_shear =
        r->shear_by_distortion * distortion_rate + r->shear_by_volume * volume_rate;
    const columns d_pressure =
        r->pressure_by_volume * volume_rate + (r->pressure_by_strain - 2 * r->shear) * mean_rate;

    tensor3 d;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int ij = 3 * i + j, ji = 3 * j + i;
            const columns turned = m.m[i] * e[j] + m.m[3 + i] * e[3 + j] + m.m[6 + i] * e[6 + j];
            d.m[ij] = d_shear * e[ij] + r->shear * (ft_df.m[ij] + ft_df.m[ji] - turned) -
                      r->pressure * m.m[ji];
            if (i == j) d.m[ij] += d_pressure;
        }
    tensor3 dp;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            dp.m[3 * i + j] =
                g[3 * i] * d.m[j] + g[3 * i + 1] * d.m[3 + j] + g[3 * i + 2] * d.m[6 + j];
    return dp;
}

static inline real law_parameter_energy(const material_law* l, const law_state* s, int k) {
    return s->is_valid ? law_parameter_response(l, &s->strain, k).energy : (real)0;
}

static inline void law_parameter_stress(const material_law* l, const law_state* s, int k,
                                        real* stress) {
    const parameter_response r = law_parameter_response(l, &s->strain, k);
    mandel_to_piola(&s->strain, s->is_valid ? r.shear : (real)0, s->is_valid ? r.pressure : (real)0,
                    stress);
}

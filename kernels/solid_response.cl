// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// What a point of an element answers, whether each has the volume change that the displacement
// gives it there or, with HAS_MEAN_VOLUME, all points have one theta in common; formulas and
// reasons are those of solver/model/mean_volume.hpp. Defines: HAS_MEAN_VOLUME 0 or 1;
// LAW_IS_SMALL_STRAIN comes with the law.
#if !defined(HAS_MEAN_VOLUME)
#error "HAS_MEAN_VOLUME must be defined"
#endif

#if !HAS_MEAN_VOLUME
typedef struct {
    int is_valid;
} element_mean;

typedef struct {
    law_state state;
} point_response;

static inline element_mean mean_of_element(const material_law* law, global const int* nodes,
                                           global const real* points, global const real* u) {
    const element_mean mean = {1};
    return mean;
}

static inline point_response response_at(const material_law* law, const element_mean* mean,
                                         global const int* nodes, global const real* point,
                                         global const real* u) {
    point_response r;
    r.state = state_at(law, nodes, point, u);
    return r;
}

static inline void response_stress(const material_law* law, const element_mean* mean,
                                   const point_response* r, real* p) {
    law_stress(law, &r->state, p);
}

static inline tensor3 response_change(const material_law* law, const element_mean* mean,
                                      const point_response* r, const tensor3* dh,
                                      columns theta_change, columns* pressure_change) {
    *pressure_change = (columns)(0);
    return law_tangent_apply(law, &r->state, dh);
}
#else
typedef struct {
    real volume;        // V
    real theta_change;  // theta - 1
    real pressure;      // pi = (1/V) dW/dtheta
    int is_valid;
} element_mean;

typedef struct {
    law_state state;  // of H'
    real f[9];        // F
    real g[9];        // F^-T
    real stress[9];   // P(F')
    real ratio;       // J
    real scale;       // s = (theta / J)^(1/3), F' = s F
    real p;           // theta dW_q/dtheta
} point_response;

// J - 1, at small strains tr H.
static inline real volume_change_of(const real* h) {
#if LAW_IS_SMALL_STRAIN
    return h[0] + h[4] + h[8];
#else
    real c[9];
    cofactors(h, c);
    return h[0] + h[4] + h[8] + (c[0] + c[4] + c[8] + (h[0] * c[0] + h[1] * c[1] + h[2] * c[2]));
#endif
}

static inline point_response response_at(const material_law* law, const element_mean* mean,
                                         global const int* nodes, global const real* point,
                                         global const real* u) {
    point_response r;
    real h[9];
    state_gradient(nodes, point, u, h);
    const real change = volume_change_of(h);
    for (int i = 0; i < 9; ++i) r.f[i] = i % 4 == 0 ? (real)1 : (real)0;
#if LAW_IS_SMALL_STRAIN
    // H' = H + (theta - 1 - tr H) I / 3
    r.ratio = 1;
    r.scale = 1;
    for (int i = 0; i < 9; ++i) r.g[i] = r.f[i];
    for (int i = 0; i < 9; i += 4) h[i] += (mean->theta_change - change) / 3;
#else
    // H' = s H + (s - 1) I keeps its digits near rest
    const real log_scale = (log1p(mean->theta_change) - log1p(change)) / 3;
    const real less_one = expm1(log_scale);
    r.ratio = 1 + change;
    r.scale = 1 + less_one;
    for (int i = 0; i < 9; ++i) r.f[i] += h[i];
    cofactors(r.f, r.g);
    for (int i = 0; i < 9; ++i) {
        r.g[i] /= r.ratio;
        h[i] = r.scale * h[i] + (i % 4 == 0 ? less_one : (real)0);
    }
#endif
    r.state = state_of_law(law, h);
    law_stress(law, &r.state, r.stress);
    r.p = 0;
    for (int i = 0; i < 9; ++i) r.p += r.scale * r.stress[i] * r.f[i] / 3;
    return r;
}

static inline element_mean mean_of_element(const material_law* law, global const int* nodes,
                                           global const real* points, global const real* u) {
    element_mean mean = {0, 0, 0, 1};
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = points + q * REALS_PER_POINT;
        real h[9];
        state_gradient(nodes, point, u, h);
        const real change = volume_change_of(h);
#if !LAW_IS_SMALL_STRAIN
        mean.is_valid = mean.is_valid && 1 + change > 0;
#endif
        mean.volume += point[VOLUME_AT];
        mean.theta_change += point[VOLUME_AT] * change;
    }
    mean.theta_change /= mean.volume;
    if (!mean.is_valid) mean.theta_change = 0;
    for (int q = 0; q < POINTS_PER_ELEMENT; ++q) {
        global const real* point = points + q * REALS_PER_POINT;
        const point_response r = response_at(law, &mean, nodes, point, u);
        // pi = (1/V) sum volume dW_q/dtheta
        mean.pressure += point[VOLUME_AT] / mean.volume * r.p;
        mean.is_valid = mean.is_valid && r.state.is_valid;
    }
#if !LAW_IS_SMALL_STRAIN
    mean.pressure /= 1 + mean.theta_change;
#endif
    return mean;
}

// dJ/dH = J F^-T
static inline real volume_slope(const point_response* r, int i) { return r->ratio * r->g[i]; }

// The same without the law.
static inline void volume_slope_at(global const int* nodes, global const real* point,
                                   global const real* u, real* slope) {
#if LAW_IS_SMALL_STRAIN
    for (int i = 0; i < 9; ++i) slope[i] = i % 4 == 0 ? (real)1 : (real)0;
#else
    real f[9];
    state_gradient(nodes, point, u, f);
    for (int i = 0; i < 9; i += 4) f[i] += 1;
    cofactors(f, slope);
#endif
}

static inline void response_stress(const material_law* law, const element_mean* mean,
                                   const point_response* r, real* p) {
    // s P' - p g + pi J g
    for (int i = 0; i < 9; ++i)
        p[i] = r->scale * r->stress[i] - r->p * r->g[i] + mean->pressure * volume_slope(r, i);
}

// dH' of dH and of the element's dtheta.
static inline tensor3 response_direction(const element_mean* mean, const point_response* r,
                                         const tensor3* dh, columns theta_change) {
    columns rate = (columns)(0);
    for (int i = 0; i < 9; ++i) rate += r->g[i] * dh->m[i];
#if LAW_IS_SMALL_STRAIN
    const columns scale_change = (theta_change - rate) / 3;
#else
    const columns scale_change = r->scale / 3 * (theta_change / (1 + mean->theta_change) - rate);
#endif
    tensor3 df;
    for (int i = 0; i < 9; ++i) df.m[i] = r->scale * dh->m[i] + scale_change * r->f[i];
    return df;
}

// dP while pi is held; `pressure_change`: of dW_q/dtheta.
static inline tensor3 response_change(const material_law* law, const element_mean* mean,
                                      const point_response* r, const tensor3* dh,
                                      columns theta_change, columns* pressure_change) {
    const tensor3 df = response_direction(mean, r, dh, theta_change);
    tensor3 dp = law_tangent_apply(law, &r->state, &df);
    columns p_change = (columns)(0);
#if LAW_IS_SMALL_STRAIN
    for (int i = 0; i < 9; i += 4) p_change += dp.m[i] / 3;
    for (int i = 0; i < 9; i += 4) dp.m[i] -= p_change;
    *pressure_change = p_change;
#else
    columns rate = (columns)(0);
    for (int i = 0; i < 9; ++i) {
        rate += r->g[i] * dh->m[i];
        p_change += (r->scale * r->f[i] * dp.m[i] + r->stress[i] * df.m[i]) / 3;
    }
    const real theta = 1 + mean->theta_change;
    *pressure_change = (p_change - r->p / theta * theta_change) / theta;
    // d(s P' - p g) + pi d(J g),  dg = -g dH^T g
    const columns scale_change = r->scale / 3 * (theta_change / theta - rate);
    const real on_mean = mean->pressure * r->ratio;
    tensor3 turned;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            turned.m[3 * i + j] =
                dh->m[i] * r->g[j] + dh->m[3 + i] * r->g[3 + j] + dh->m[6 + i] * r->g[6 + j];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int ij = 3 * i + j;
            const columns g_change = r->g[3 * i] * turned.m[j] + r->g[3 * i + 1] * turned.m[3 + j] +
                                     r->g[3 * i + 2] * turned.m[6 + j];
            dp.m[ij] = scale_change * r->stress[ij] + r->scale * dp.m[ij] +
                       (on_mean * rate - p_change) * r->g[ij] + (r->p - on_mean) * g_change;
        }
#endif
    return dp;
}
#endif

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Strain of a displacement gradient H = F - I, exact in relative terms as H goes to zero. With
// E = (H + H^T + H^T H) / 2, t = tr E / 3 and e = E - t I:
//   J - 1 = tr H + (sum of the principal minors) + det H
//   log_distortion = ln det(I + 2 e / (1 + 2 t)) = ln (I3 / (I1/3)^3)
// The formulas and their reasons are those of solver/materials/finite_strain.hpp.
#define SMALLEST_VOLUME_RATIO ((real)1e-6f)
#define LARGEST_SQUARE_STRETCH ((real)1e4f)
#define LARGEST_STRESS_KPA ((real)1e15f)

typedef struct {
    real f[9];                   // F
    real inverse_transposed[9];  // F^-T
    real twice_deviator[9];      // 2 e
    real mean;                   // t
    real square_stretch;         // 1 + 2 t
    real volume_change;          // J - 1
    real log_volume;             // ln J
    real log_distortion;
    int is_valid;
} finite_strain;

// F^T P = shear 2 e + pressure I and its changes, kPa; with M = F^-1 dF, g = tr M, dt = tr dE / 3:
//   d shear = shear_by_distortion (2 e : M) + shear_by_volume g
//   d pressure = pressure_by_volume g + pressure_by_strain dt
typedef struct {
    real energy;
    real shear;
    real shear_by_distortion;
    real shear_by_volume;
    real pressure;
    real pressure_by_volume;
    real pressure_by_strain;
} response;

// Derivatives by one parameter.
typedef struct {
    real energy;
    real shear;
    real pressure;
} parameter_response;

static inline void cofactors(const real* a, real* c) {
#pragma unroll
    for (int i = 0; i < 3; ++i)
#pragma unroll
        for (int j = 0; j < 3; ++j) {
            const int i1 = 3 * ((i + 1) % 3), i2 = 3 * ((i + 2) % 3);
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[3 * i + j] = a[i1 + j1] * a[i2 + j2] - a[i1 + j2] * a[i2 + j1];
        }
}

// x - ln(1 + x), by the series in r = x / (2 + x) near zero.
static inline real minus_log1p(real x) {
    const real r = x / (2 + x);
    const real r2 = r * r;
    real series = 0;
    for (int n = 23; n >= 3; n -= 2) series = series * r2 + (real)1 / n;
    return fabs(x) < (real)0.25f ? r * (x - 2 * r2 * series) : x - log1p(x);
}

static inline real log_distortion_of(const finite_strain* s) {
    real epsilon[9], c[9];
    real squares = 0;
    for (int i = 0; i < 9; ++i) {
        epsilon[i] = s->twice_deviator[i] / s->square_stretch;
        squares += epsilon[i] * epsilon[i];
    }
    cofactors(epsilon, c);
    const real change = epsilon[0] * c[0] + epsilon[1] * c[1] + epsilon[2] * c[2] - squares / 2;
    return change > (real)-0.5f ? log1p(change) : 2 * s->log_volume - 3 * log(s->square_stretch);
}

static inline finite_strain strain_within_limits(const real* h) {
    finite_strain s;
    real c[9];
    cofactors(h, c);
    s.volume_change =
        h[0] + h[4] + h[8] + (c[0] + c[4] + c[8] + (h[0] * c[0] + h[1] * c[1] + h[2] * c[2]));
    for (int i = 0; i < 9; ++i) s.f[i] = h[i] + (i % 4 == 0 ? (real)1 : (real)0);
    cofactors(s.f, s.inverse_transposed);
    for (int i = 0; i < 9; ++i) s.inverse_transposed[i] /= 1 + s.volume_change;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            s.twice_deviator[3 * i + j] = h[i] * h[j] + h[3 + i] * h[3 + j] + h[6 + i] * h[6 + j] +
                                          (h[3 * i + j] + h[3 * j + i]);
    s.mean = (s.twice_deviator[0] + s.twice_deviator[4] + s.twice_deviator[8]) / 6;
    for (int i = 0; i < 9; i += 4) s.twice_deviator[i] -= 2 * s.mean;
    s.square_stretch = 1 + 2 * s.mean;
    s.is_valid = 1 + s.volume_change > SMALLEST_VOLUME_RATIO && s.square_stretch > 0 &&
                 s.square_stretch < LARGEST_SQUARE_STRETCH;
    s.log_volume = log1p(s.volume_change);
    s.log_distortion = log_distortion_of(&s);
    return s;
}

// A state that is not valid is replaced by the state of rest, so that nothing becomes NaN.
static inline finite_strain finite_strain_of(const real* h) {
    finite_strain s = strain_within_limits(h);
    if (s.is_valid) return s;
    const real rest[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    s = strain_within_limits(rest);
    s.is_valid = 0;
    return s;
}

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// 3x3 and 3-vector algebra, per column. Entry (i, j) of a tensor is m[3 i + j].
typedef struct {
    columns m[9];
} tensor3;

typedef struct {
    columns c[3];
} vector3;

static inline columns trace(const tensor3* a) { return a->m[0] + a->m[4] + a->m[8]; }

// 1/2 (a + a^T) : the symmetric part.
static inline tensor3 symmetric_part(const tensor3* a) {
    const real half_of = (real)0.5;
    tensor3 s;
#pragma unroll
    for (int i = 0; i < 3; ++i)
#pragma unroll
        for (int j = 0; j < 3; ++j) s.m[3 * i + j] = half_of * (a->m[3 * i + j] + a->m[3 * j + i]);
    return s;
}

// a : b, the sum over all entries of the products.
static inline columns double_dot(const tensor3* a, const tensor3* b) {
    columns sum = a->m[0] * b->m[0];
#pragma unroll
    for (int i = 1; i < 9; ++i) sum += a->m[i] * b->m[i];
    return sum;
}

// a += u (outer product) g, with g the same for every column.
static inline void add_outer(tensor3* a, const vector3* u, const real* g) {
#pragma unroll
    for (int i = 0; i < 3; ++i)
#pragma unroll
        for (int j = 0; j < 3; ++j) a->m[3 * i + j] += u->c[i] * g[j];
}

// a g
static inline vector3 tensor_times(const tensor3* a, const real* g) {
    vector3 y;
#pragma unroll
    for (int i = 0; i < 3; ++i)
        y.c[i] = a->m[3 * i] * g[0] + a->m[3 * i + 1] * g[1] + a->m[3 * i + 2] * g[2];
    return y;
}

// a x b of plain numbers.
static inline void cross_wide(const wide* a, const wide* b, wide* c) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline wide dot_wide(const wide* a, const wide* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Inverse of a symmetric 3x3 matrix by cofactors; the identity if it is singular (a node without
// elements).
static inline void invert_symmetric(const wide* a, wide* inverse) {
    const wide c00 = a[4] * a[8] - a[5] * a[5];
    const wide c01 = a[5] * a[2] - a[1] * a[8];
    const wide c02 = a[1] * a[5] - a[4] * a[2];
    const wide determinant = a[0] * c00 + a[1] * c01 + a[2] * c02;
    const bool regular = determinant > (wide)0;
    const wide f = regular ? (wide)1 / determinant : (wide)1;
    inverse[0] = regular ? c00 * f : (wide)1;
    inverse[4] = regular ? (a[0] * a[8] - a[2] * a[2]) * f : (wide)1;
    inverse[8] = regular ? (a[0] * a[4] - a[1] * a[1]) * f : (wide)1;
    inverse[1] = inverse[3] = regular ? c01 * f : (wide)0;
    inverse[2] = inverse[6] = regular ? c02 * f : (wide)0;
    inverse[5] = inverse[7] = regular ? (a[1] * a[2] - a[0] * a[5]) * f : (wide)0;
}

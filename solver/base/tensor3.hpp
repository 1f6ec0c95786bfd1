// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "solver/base/device.hpp"

// 3x3 algebra in plain arrays, for host loops and device kernels; the twin of kernels/tensor3.cl.
namespace palpate {

/// A 3x3 tensor; entry (i, j) is m[3 i + j].
template <typename Real>
struct Tensor3 {
    Real m[9];
};

template <typename Real>
PALPATE_DEVICE Real trace(const Tensor3<Real>& a) {
    return a.m[0] + a.m[4] + a.m[8];
}

/// a : b, the sum over all entries of the products.
template <typename Real>
PALPATE_DEVICE Real double_dot(const Tensor3<Real>& a, const Tensor3<Real>& b) {
    Real sum = 0;
    for (int i = 0; i < 9; ++i) sum += a.m[i] * b.m[i];
    return sum;
}

/// a += s I
template <typename Real>
PALPATE_DEVICE void add_diagonal(Tensor3<Real>& a, std::type_identity_t<Real> s) {
    for (int i = 0; i < 3; ++i) a.m[4 * i] += s;
}

/// s a
template <typename Real>
PALPATE_DEVICE Tensor3<Real> scaled(const Tensor3<Real>& a, std::type_identity_t<Real> s) {
    Tensor3<Real> b;
    for (int i = 0; i < 9; ++i) b.m[i] = s * a.m[i];
    return b;
}

/// a x + b y
template <typename Real>
PALPATE_DEVICE Tensor3<Real> sum_of(std::type_identity_t<Real> a, const Tensor3<Real>& x,
                                    std::type_identity_t<Real> b, const Tensor3<Real>& y) {
    Tensor3<Real> sum;
    for (int i = 0; i < 9; ++i) sum.m[i] = a * x.m[i] + b * y.m[i];
    return sum;
}

/// a + a^T
template <typename Real>
PALPATE_DEVICE Tensor3<Real> twice_symmetric_part(const Tensor3<Real>& a) {
    Tensor3<Real> s;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) s.m[3 * i + j] = a.m[3 * i + j] + a.m[3 * j + i];
    return s;
}

/// a b
template <typename Real>
PALPATE_DEVICE Tensor3<Real> times(const Tensor3<Real>& a, const Tensor3<Real>& b) {
    Tensor3<Real> c;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            c.m[3 * i + j] =
                a.m[3 * i] * b.m[j] + a.m[3 * i + 1] * b.m[3 + j] + a.m[3 * i + 2] * b.m[6 + j];
    return c;
}

/// a^T b
template <typename Real>
PALPATE_DEVICE Tensor3<Real> transposed_times(const Tensor3<Real>& a, const Tensor3<Real>& b) {
    Tensor3<Real> c;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            c.m[3 * i + j] = a.m[i] * b.m[j] + a.m[3 + i] * b.m[3 + j] + a.m[6 + i] * b.m[6 + j];
    return c;
}

/// The matrix of cofactors: det(a) a^-T.
template <typename Real>
PALPATE_DEVICE Tensor3<Real> cofactors(const Tensor3<Real>& a) {
    Tensor3<Real> c;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = 3 * ((i + 1) % 3), i2 = 3 * ((i + 2) % 3);
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c.m[3 * i + j] = a.m[i1 + j1] * a.m[i2 + j2] - a.m[i1 + j2] * a.m[i2 + j1];
        }
    return c;
}

/// det(I + a) - 1 = tr a + (sum of the principal minors) + det a, exact for small a.
template <typename Real>
PALPATE_DEVICE Real determinant_change(const Tensor3<Real>& a) {
    const Tensor3<Real> c = cofactors(a);
    const Real determinant = a.m[0] * c.m[0] + a.m[1] * c.m[1] + a.m[2] * c.m[2];
    return trace(a) + (trace(c) + determinant);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "solver/elements/element.hpp"

// Shape functions on simplices, written in the barycentric coordinates
//   L_0 = 1 - xi_1 - .. - xi_d,  L_i = xi_i.
namespace palpate {

template <int dimension>
struct Barycentric {
    double value[dimension + 1];
    double gradient[dimension + 1][dimension];
};

template <int dimension>
Barycentric<dimension> barycentric(const double* xi) {
    Barycentric<dimension> l{};
    l.value[0] = 1.0;
    for (int i = 0; i < dimension; ++i) {
        l.value[0] -= xi[i];
        l.value[i + 1] = xi[i];
        l.gradient[0][i] = -1.0;
        l.gradient[i + 1][i] = 1.0;
    }
    return l;
}

/// N_a = L_a
template <int dimension>
void linear_simplex(const double* xi, ShapeFunctions& out) {
    const auto l = barycentric<dimension>(xi);
    for (int a = 0; a <= dimension; ++a) {
        out.value[a] = l.value[a];
        for (int j = 0; j < dimension; ++j) out.gradient[a][j] = l.gradient[a][j];
    }
}

/// Corners N_a = L_a (2 L_a - 1), middle of the edge (p, q) N = 4 L_p L_q.
template <int dimension, std::size_t num_edges>
void quadratic_simplex(const double* xi, const std::array<std::array<int, 2>, num_edges>& edges,
                       ShapeFunctions& out) {
    const auto l = barycentric<dimension>(xi);
    for (int a = 0; a <= dimension; ++a) {
        out.value[a] = l.value[a] * (2 * l.value[a] - 1);
        for (int j = 0; j < dimension; ++j)
            out.gradient[a][j] = (4 * l.value[a] - 1) * l.gradient[a][j];
    }
    int a = dimension + 1;
    for (const auto& [p, q] : edges) {
        out.value[a] = 4 * l.value[p] * l.value[q];
        for (int j = 0; j < dimension; ++j)
            out.gradient[a][j] =
                4 * (l.gradient[p][j] * l.value[q] + l.value[p] * l.gradient[q][j]);
        ++a;
    }
}

}  // namespace palpate

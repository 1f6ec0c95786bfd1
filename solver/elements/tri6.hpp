// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/elements/element_shape.hpp"
#include "solver/elements/simplex_shapes.hpp"

namespace palpate {

/// Middles of the edges after the corners, as VTK numbers them.
constexpr std::array<std::array<int, 2>, 3> tri6_edges{{{0, 1}, {1, 2}, {2, 0}}};

/// Quadratic triangle, three points inside, exact for polynomials of degree 2.
inline ElementShape tri6_shape() {
    static constexpr double a = 2.0 / 3, b = 1.0 / 6;
    static constexpr double place[] = {b, b, a, b, b, a};
    static constexpr double weight[] = {1.0 / 6, 1.0 / 6, 1.0 / 6};
    static constexpr double reference[] = {0, 0, 1, 0, 0, 1, 0.5, 0, 0.5, 0.5, 0, 0.5};
    return {
        "tri6",
        2,
        6,
        3,
        [](const double* xi, ShapeFunctions& out) { quadratic_simplex<2>(xi, tri6_edges, out); },
        reference,
        place,
        weight,
        {{0, 1, 3}, {1, 2, 4}, {2, 0, 5}}};
}

}  // namespace palpate

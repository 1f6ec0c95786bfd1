// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/elements/element_shape.hpp"
#include "solver/elements/simplex_shapes.hpp"

namespace palpate {

/// Middles of the edges after the corners, as VTK numbers them.
constexpr std::array<std::array<int, 2>, 6> tet10_edges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Quadratic tetrahedron, four points, exact for polynomials of degree 2 (Hammer, Marlowe and
/// Stroud 1956): at the places with one barycentric coordinate a and three b.
inline ElementShape tet10_shape() {
    static constexpr double a = 0.58541019662496845446, b = 0.13819660112501051518;
    static constexpr double place[] = {b, b, b, a, b, b, b, a, b, b, b, a};
    static constexpr double weight[] = {1.0 / 24, 1.0 / 24, 1.0 / 24, 1.0 / 24};
    static constexpr double reference[] = {0, 0, 0,   1,   0,   0,   0,   1, 0,   0,
                                           0, 1, 0.5, 0,   0,   0.5, 0.5, 0, 0,   0.5,
                                           0, 0, 0,   0.5, 0.5, 0,   0.5, 0, 0.5, 0.5};
    return {
        "tet10",
        3,
        10,
        4,
        [](const double* xi, ShapeFunctions& out) { quadratic_simplex<3>(xi, tet10_edges, out); },
        reference,
        place,
        weight,
        {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}}};
}

}  // namespace palpate

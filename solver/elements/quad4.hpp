// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/elements/element_shape.hpp"

namespace palpate {

/// Bilinear quadrilateral on [-1, 1]^2, corners counter-clockwise from (-1, -1), 2 x 2 Gauss
/// points.
inline ElementShape quad4_shape() {
    static constexpr double g = 0.57735026918962576451;
    static constexpr double place[] = {-g, -g, g, -g, g, g, -g, g};
    static constexpr double weight[] = {1, 1, 1, 1};
    static constexpr double reference[] = {-1, -1, 1, -1, 1, 1, -1, 1};
    return {"quad4",
            2,
            4,
            4,
            [](const double* xi, ShapeFunctions& out) {
                for (int a = 0; a < 4; ++a) {
                    const double s = reference[2 * a], t = reference[2 * a + 1];
                    out.value[a] = 0.25 * (1 + s * xi[0]) * (1 + t * xi[1]);
                    out.gradient[a][0] = 0.25 * s * (1 + t * xi[1]);
                    out.gradient[a][1] = 0.25 * t * (1 + s * xi[0]);
                }
            },
            reference,
            place,
            weight,
            {{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
}

}  // namespace palpate

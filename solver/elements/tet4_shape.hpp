// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/elements/element_shape.hpp"
#include "solver/elements/simplex_shapes.hpp"

namespace palpate {

/// Linear tetrahedron, one point.
inline ElementShape tet4_shape() {
    static constexpr double place[] = {0.25, 0.25, 0.25};
    static constexpr double weight[] = {1.0 / 6};
    static constexpr double reference[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    return {"tet4",
            3,
            4,
            4,
            linear_simplex<3>,
            reference,
            place,
            weight,
            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/elements/element_shape.hpp"
#include "solver/elements/simplex_shapes.hpp"

namespace palpate {

/// Linear triangle, one point.
inline ElementShape tri3_shape() {
    static constexpr double place[] = {1.0 / 3, 1.0 / 3};
    static constexpr double weight[] = {0.5};
    static constexpr double reference[] = {0, 0, 1, 0, 0, 1};
    return {"tri3", 2, 3, 3, linear_simplex<2>, reference, place, weight, {{0, 1}, {1, 2}, {2, 0}}};
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solver/elements/element.hpp"

namespace palpate {

/// One type as its header describes it; `shapes` writes N_a and dN_a / d xi_j at xi.
struct ElementShape {
    const char* name;
    int dimension, num_nodes, num_corners;
    void (*shapes)(const double* xi, ShapeFunctions& out);
    std::span<const double> reference;  ///< [num_nodes, dimension]
    std::span<const double> place;      ///< [num_points, dimension]
    std::span<const double> weight;     ///< [num_points]
    std::vector<std::vector<int>> faces;
};

}  // namespace palpate

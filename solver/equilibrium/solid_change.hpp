// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/base/tensor3.hpp"

namespace palpate {

/// A direction in what forces are made of at held displacements, per unit of one parameter.
struct SolidChange {
    std::vector<std::vector<double>> parameters;  ///< [materials][parameters]; empty: none
    std::vector<double> factor;                   ///< [materials] of a viscous step; empty: none
    std::vector<Tensor3<double>> prestress;       ///< [num_elements, num_points]; empty: none
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/linear/sparse_factor.hpp"

namespace palpate {

/// Eigen's simplicial LDL^T with approximate minimum degree ordering: always there, column by
/// column, ten times slower to set up than supernodes from 10,000 unknowns on.
std::unique_ptr<SparseFactor> make_eigen_factor();

}  // namespace palpate

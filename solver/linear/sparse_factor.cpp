// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/sparse_factor.hpp"

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double smallest_pivot_ratio = 1e-14;  ///< below: a mechanism, not a stiff structure

}  // namespace

void SparseFactor::require_definite(bool finished, double smallest_pivot, double largest_pivot) {
    if (finished && smallest_pivot > smallest_pivot_ratio * largest_pivot) return;
    throw Error(ErrorCode::solve_failed,
                "The stiffness matrix is singular: a part of the mesh is free to move rigidly; "
                "prescribe the displacement of at least three of its nodes.");
}

}  // namespace palpate

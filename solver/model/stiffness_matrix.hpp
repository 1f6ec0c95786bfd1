// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solver/model/block_matrix.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// K(E) of a whole model without regard to prescribed dofs, mN/mm, 3x3 blocks in the pattern of
/// `node_graph`: the matrix of the direct solver, and the judge of every residual.
struct StiffnessMatrix : BlockMatrix {
    Index num_nodes() const { return num_rows(); }
};

StiffnessMatrix assemble_stiffness(const Model& model);

/// y = K x on the nodes [first, last) only, for `columns` columns.
///   x        [3 num_nodes, columns], column index fastest
///   y        [3 (last - first), columns], overwritten
///   nonzero  [num_nodes] 0 where all three rows of x are zero (skipped); empty: none known
void multiply_rows(const StiffnessMatrix& stiffness, Index first, Index last, const double* x,
                   Index columns, std::span<const unsigned char> nonzero, double* y);

}  // namespace palpate

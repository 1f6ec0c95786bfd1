// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solver/mesh/node_elements.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// K(E) of a whole model on the host in fp64, without regard to prescribed dofs, as 3x3 block rows:
/// the matrix of the direct solver, and the judge of every residual.
struct StiffnessMatrix {
    Adjacency graph;             ///< `node_graph` of the mesh
    std::vector<double> blocks;  ///< [graph.items.size(), 3, 3] mN/mm, each block row by row

    Index num_nodes() const { return graph.num_lists(); }
};

StiffnessMatrix assemble_stiffness(const Model& model);

/// y = K x on the nodes [first, last) only, for `columns` columns.
///   x        [3 num_nodes, columns], column index fastest
///   y        [3 (last - first), columns], overwritten
///   nonzero  [num_nodes] 0 where all three rows of x are zero (skipped); empty: none known
void multiply_rows(const StiffnessMatrix& stiffness, Index first, Index last, const double* x,
                   Index columns, std::span<const unsigned char> nonzero, double* y);

}  // namespace palpate

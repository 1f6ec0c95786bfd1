// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/model/block_matrix.hpp"

namespace palpate {

/// Row-wise work of the set-up, for block sizes b = 3 (mesh) and b = 6 (aggregates). Each handles
/// the block rows [first, last) and writes only those, so that rows can be shared among threads.
/// Blocks are row by row.

/// y = A x
///   x, y  [num_nodes, b]
void multiply_block_rows(const BlockMatrix& a, Index first, Index last, const double* x, double* y);

/// P = (I - omega D^-1 A) T, one damped Jacobi step on the tentative prolongation.
///   inverse_diagonal  [num_nodes, b, b]
///   of_node           [num_nodes] block column of T's only block in each row, -1: none
///   tentative         [num_nodes, b, 6] these blocks
void smooth_prolongation(const BlockMatrix& a, Index first, Index last,
                         const double* inverse_diagonal, double omega, const Index* of_node,
                         const double* tentative, BlockMatrix& p);

/// C = A P in the pattern of `c`.
void multiply_prolongation(const BlockMatrix& a, const BlockMatrix& p, Index first, Index last,
                           BlockMatrix& c);

/// The block rows [first, last) of P^T C in the pattern of `coarse`, only the blocks on and above
/// the diagonal: for C = A P the result is symmetric.
///   members, entries  block rows of P with a block in each block column, and that block's number
void multiply_restriction(const BlockMatrix& p, const Adjacency& members, const Index* entries,
                          const BlockMatrix& c, Index first, Index last, BlockMatrix& coarse);

/// Blocks below the diagonal from those above it, for the block rows [first, last) of a matrix with
/// a symmetric pattern.
void mirror_upper_triangle(BlockMatrix& matrix, Index first, Index last);

}  // namespace palpate

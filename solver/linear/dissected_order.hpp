// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace palpate {

/// Whether this build has SCOTCH, which comes with MUMPS.
bool has_dissection();

/// [n] the place of each row in an order that keeps the Cholesky factor sparse: nested dissection
/// by SCOTCH (Pellegrini, Roman, Amestoy, Concurrency: Practice and Experience 12, 2000).
/// Neighbouring rows of one pattern, as the three of a node are, stay together. The same matrix
/// gets the same order on every call and in every process.
/// `lower`: the lower triangle with its diagonal, rows of each column ascending.
/// Throws Error(solve_failed) if SCOTCH refuses the graph, Error(unsupported) without it.
std::vector<int> dissected_order(const Eigen::SparseMatrix<double>& lower);

}  // namespace palpate

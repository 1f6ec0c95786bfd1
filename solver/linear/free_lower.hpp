// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/linear/free_dofs.hpp"
#include "solver/linear/sparse_factor.hpp"

namespace palpate {

/// The lower triangle of a symmetric matrix of 3x3 blocks on its free dofs, for one matrix after
/// another of the same graph: where each entry comes from is found once.
class FreeLower {
public:
    FreeLower(const Adjacency& graph, const FreeDofs& free);
    /// That of a matrix with this graph; valid until the next call.
    ///   shift   times the mean size of the diagonal is added to that
    const SparseFactor::Lower& fill(const BlockMatrix& matrix, double shift = 0);

private:
    SparseFactor::Lower lower_;
    std::vector<std::size_t> places_;  ///< [entries of `lower_`] in `BlockMatrix::blocks`
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/free_lower.hpp"

#include <cmath>

namespace palpate {

// The matrix is symmetric, so the columns of its lower triangle are read off as rows.
FreeLower::FreeLower(const Adjacency& graph, const FreeDofs& free)
    : lower_(free.count, free.count) {
    places_.reserve(graph.items.size() * 9 / 2 + static_cast<std::size_t>(free.count));
    lower_.reserve(static_cast<Eigen::Index>(places_.capacity()));
    for (Index d = 0; d < static_cast<Index>(free.number.size()); ++d) {
        const Index column = free.number[d];
        if (column < 0) continue;
        lower_.startVec(column);
        for (Index k = graph.offsets[d / 3]; k < graph.offsets[d / 3 + 1]; ++k)
            for (Index i = 0; i < 3; ++i) {
                const Index row = free.number[3 * graph.items[k] + i];
                if (row < column) continue;
                lower_.insertBack(row, column) = 0;
                places_.push_back(9 * static_cast<std::size_t>(k) +
                                  static_cast<std::size_t>(3 * (d % 3) + i));
            }
    }
    lower_.finalize();
}

const SparseFactor::Lower& FreeLower::fill(const BlockMatrix& matrix, double shift) {
    double* entry = lower_.valuePtr();
    for (std::size_t k = 0; k < places_.size(); ++k) entry[k] = matrix.blocks[places_[k]];
    if (shift == 0) return lower_;
    const int* first = lower_.outerIndexPtr();  // of each column: its diagonal
    double size = 0;
    for (Eigen::Index c = 0; c < lower_.cols(); ++c) size += std::abs(entry[first[c]]);
    for (Eigen::Index c = 0; c < lower_.cols(); ++c)
        entry[first[c]] += shift * size / static_cast<double>(lower_.cols());
    return lower_;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/free_dofs.hpp"

namespace palpate {

FreeDofs number_free_dofs(const Adjacency& graph, std::span<const std::uint8_t> prescribed) {
    FreeDofs free;
    free.number.assign(prescribed.size(), -1);
    for (Index d = 0; d < static_cast<Index>(prescribed.size()); ++d) {
        const bool has_elements = graph.offsets[d / 3 + 1] - graph.offsets[d / 3] > 1;
        if (has_elements && !prescribed[d]) free.number[d] = free.count++;
    }
    return free;
}

// The matrix is symmetric, so the columns of its lower triangle are read off as rows.
SparseFactor::Lower free_lower(const BlockMatrix& matrix, const FreeDofs& free) {
    SparseFactor::Lower lower(free.count, free.count);
    lower.reserve(static_cast<Eigen::Index>(matrix.blocks.size()) / 2 + free.count);
    const Adjacency& graph = matrix.graph;
    for (Index d = 0; d < static_cast<Index>(free.number.size()); ++d) {
        const Index column = free.number[d];
        if (column < 0) continue;
        lower.startVec(column);
        for (Index k = graph.offsets[d / 3]; k < graph.offsets[d / 3 + 1]; ++k)
            for (Index i = 0; i < 3; ++i) {
                const Index row = free.number[3 * graph.items[k] + i];
                if (row >= column) lower.insertBack(row, column) = matrix.block(k)[3 * (d % 3) + i];
            }
    }
    lower.finalize();
    return lower;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "solver/base/types.hpp"
#include "solver/model/block_matrix.hpp"

namespace palpate {

/// Adds to one block of a matrix that has it in its pattern.
inline void add_block(BlockMatrix& matrix, Index row, Index column, const Mat3& values) {
    const auto begin = matrix.graph.items.begin() + matrix.graph.offsets[row];
    const auto end = matrix.graph.items.begin() + matrix.graph.offsets[row + 1];
    const auto at = std::lower_bound(begin, end, column);
    double* block = matrix.block(static_cast<Index>(at - matrix.graph.items.begin()));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) block[3 * i + j] += values(i, j);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/mesh/node_elements.hpp"

namespace palpate {

/// A sparse matrix of equal dense blocks in compressed rows, on the host in fp64.
struct BlockMatrix {
    Adjacency graph;             ///< per block row the numbers of its block columns, ascending
    Index num_columns = 0;       ///< block columns
    int block_rows = 3;          ///< rows of one block
    int block_columns = 3;       ///< columns of one block
    std::vector<double> blocks;  ///< [graph.items.size(), block_rows, block_columns], row by row

    Index num_rows() const { return graph.num_lists(); }
    int block_size() const { return block_rows * block_columns; }
    const double* block(Index k) const {
        return blocks.data() + static_cast<std::size_t>(k) * block_size();
    }
    double* block(Index k) { return blocks.data() + static_cast<std::size_t>(k) * block_size(); }
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solver/model/block_matrix.hpp"

namespace palpate {

/// The degrees of freedom that a solve finds, numbered without gaps.
struct FreeDofs {
    std::vector<Index> number;  ///< [num_dofs], -1 where the displacement is given
    Index count = 0;
};

/// Nodes of no element have no stiffness and stay where they are.
///   graph       of the stiffness' 3x3 blocks
///   prescribed  [3 num_nodes]
FreeDofs number_free_dofs(const Adjacency& graph, std::span<const std::uint8_t> prescribed);

}  // namespace palpate

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

}  // namespace palpate

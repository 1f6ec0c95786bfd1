// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// The rows of some nodes in a field on all of them.
///   field  [3 num_nodes]; returns [3 nodes.size()]
inline Eigen::VectorXd at_nodes(const Eigen::VectorXd& field, const std::vector<Index>& nodes) {
    Eigen::VectorXd part(3 * static_cast<Index>(nodes.size()));
    for (std::size_t k = 0; k < nodes.size(); ++k)
        part.segment<3>(3 * static_cast<Index>(k)) = field.segment<3>(3 * nodes[k]);
    return part;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "solver/materials/linear.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate {

/// Everything the solver needs to know: a mesh, one material per region number, and which degrees
/// of freedom are prescribed. Degree of freedom 3 n + c is component c (x, y, z) of node n.
struct Model {
    Mesh mesh;
    std::vector<LinearElastic> materials;  ///< indexed by `mesh.region`
    std::vector<std::uint8_t> prescribed;  ///< [3 num_nodes], 1 where the displacement is given

    Index num_dofs() const { return 3 * mesh.num_nodes(); }
};

/// Throws Error(invalid_argument) naming the first broken rule: sizes, node numbers, region
/// numbers, positive volumes, material ranges.
void check_model(const Model& model);

/// The same model with node order[k] as its k-th (see `spatial_order`), checked first.
Model renumbered(const Model& model, const std::vector<Index>& order);

}  // namespace palpate

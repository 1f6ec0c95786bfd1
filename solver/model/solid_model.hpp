// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// A law of the registry with its parameters, in the order of its description.
struct SolidMaterial {
    std::string law;  ///< "neo-hookean"
    std::vector<double> parameters;
};

/// Everything that equilibrium at large deformation needs to know, but the loads.
struct SolidModel {
    SolidMesh mesh;
    std::vector<SolidMaterial> materials;  ///< indexed by `mesh.region`
    std::vector<std::uint8_t> prescribed;  ///< [3 num_nodes], 1 where the displacement is given

    Index num_dofs() const { return 3 * mesh.num_nodes(); }
};

/// Throws Error(invalid_argument) naming the first broken rule: those of `check_mesh`, laws and
/// parameters, regions without material, the size of `prescribed`, and in a plane a third component
/// that is not prescribed.
void check_model(const SolidModel& model);

/// Prescribes the third component of every node of a plane mesh.
void hold_in_plane(SolidModel& model);

}  // namespace palpate

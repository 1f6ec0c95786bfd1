// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/simulate/simulation_settings.hpp"
#include "host/geometry/meshing/solid_mesh_file.hpp"

namespace palpate {

/// The mesh that [mesh] asks for, `region` still holding labels; made quadratic at last. Throws
/// Error as `read_solid_mesh` does, and Error(invalid_argument) with the line of [mesh].
SolidMeshFile prepare_mesh(const MeshSettings& settings);

/// Turns the labels of `mesh` into numbers of materials. Returns the label of each. Throws
/// Error(invalid_argument) for labels without material and materials without elements.
std::vector<Index> number_regions(const std::vector<MaterialSettings>& materials,
                                  const MeshSettings& settings, SolidMesh& mesh);

}  // namespace palpate

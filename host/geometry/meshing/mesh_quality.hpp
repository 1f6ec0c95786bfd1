// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/mesh/mesh.hpp"

namespace palpate {

struct MeshQuality {
    Index num_nodes = 0, num_tets = 0, num_inverted = 0;
    double min_dihedral_deg = 0, max_dihedral_deg = 0;
    double min_volume_mm3 = 0;
    std::vector<double> region_volume_mm3;  ///< by region number
};

MeshQuality mesh_quality(const Mesh& mesh, Index num_regions);

}  // namespace palpate

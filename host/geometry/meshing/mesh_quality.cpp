// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/mesh_quality.hpp"

#include <algorithm>
#include <limits>

#include "host/geometry/meshing/dihedral.hpp"

namespace palpate {

MeshQuality mesh_quality(const Mesh& mesh, Index num_regions) {
    MeshQuality quality;
    quality.num_nodes = mesh.num_nodes();
    quality.num_tets = mesh.num_tets();
    quality.region_volume_mm3.assign(static_cast<std::size_t>(num_regions), 0.0);
    if (mesh.tets.empty()) return quality;
    quality.min_dihedral_deg = 180;
    quality.min_volume_mm3 = std::numeric_limits<double>::infinity();
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        const double volume = tet_volume(mesh, t);
        if (!(volume > 0)) ++quality.num_inverted;
        quality.min_volume_mm3 = std::min(quality.min_volume_mm3, volume);
        const Index region = mesh.region[t];
        if (region >= 0 && region < num_regions) quality.region_volume_mm3[region] += volume;
        const DihedralRange range = dihedral_range(mesh, t);
        quality.min_dihedral_deg = std::min(quality.min_dihedral_deg, range.min_deg);
        quality.max_dihedral_deg = std::max(quality.max_dihedral_deg, range.max_deg);
    }
    return quality;
}

}  // namespace palpate

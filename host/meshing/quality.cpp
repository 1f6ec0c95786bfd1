// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/meshing/mesher.hpp"

namespace palpate {

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

/// Widens [low, high] by the six dihedral angles (degrees). The angle at the edge shared by faces a
/// and b is pi minus the angle between their outward normals.
void include_dihedral_angles(const std::array<Vec3, 4>& p, double& low, double& high) {
    std::array<Vec3, 4> normal;  // outward, of the face opposite node i, for positive volume
    normal[0] = (p[2] - p[1]).cross(p[3] - p[1]);
    normal[1] = (p[3] - p[0]).cross(p[2] - p[0]);
    normal[2] = (p[1] - p[0]).cross(p[3] - p[0]);
    normal[3] = (p[2] - p[0]).cross(p[1] - p[0]);
    for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) {
            const double across = normal[a].cross(normal[b]).norm();
            const double angle = std::atan2(across, -normal[a].dot(normal[b])) * degrees;
            low = std::min(low, angle);
            high = std::max(high, angle);
        }
    }
}

}  // namespace

MeshQuality mesh_quality(const Mesh& mesh, Index num_regions) {
    MeshQuality quality;
    quality.num_nodes = mesh.num_nodes();
    quality.num_tets = mesh.num_tets();
    quality.region_volume_mm3.assign(static_cast<std::size_t>(num_regions), 0.0);
    if (mesh.tets.empty()) return quality;
    quality.min_dihedral_deg = 180;
    quality.min_volume_mm3 = std::numeric_limits<double>::infinity();
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        const Tet& tet = mesh.tets[t];
        const double volume = tet_volume(mesh, t);
        if (!(volume > 0)) ++quality.num_inverted;
        quality.min_volume_mm3 = std::min(quality.min_volume_mm3, volume);
        const Index region = mesh.region[t];
        if (region >= 0 && region < num_regions) quality.region_volume_mm3[region] += volume;
        include_dihedral_angles(
            {mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]], mesh.nodes[tet[3]]},
            quality.min_dihedral_deg, quality.max_dihedral_deg);
    }
    return quality;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/mesh_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace palpate {

namespace {

/// The first region whose oriented triangles do not cancel along each edge, or -1.
Index open_region(const RegionSurface& surface, const std::vector<Index>& hollow) {
    std::map<std::array<Index, 3>, int> balance;  // region, edge
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        for (int side = 0; side < 2; ++side) {
            const Index region = surface.regions[i][side];
            if (!is_meshed_region(region, hollow)) continue;
            for (int k = 0; k < 3; ++k) {
                const Index a = surface.triangles[i][k], b = surface.triangles[i][(k + 1) % 3];
                balance[{region, std::min(a, b), std::max(a, b)}] +=
                    (a < b) == (side == 0) ? 1 : -1;
            }
        }
    }
    for (const auto& [key, sum] : balance)
        if (sum != 0) return key[0];
    return -1;
}

Index num_unused_nodes(const Mesh& mesh) {
    std::vector<bool> used(mesh.nodes.size(), false);
    for (const Tet& tet : mesh.tets)
        for (Index node : tet) used[node] = true;
    return static_cast<Index>(std::count(used.begin(), used.end(), false));
}

std::string wrong_volume(const MeshQuality& quality, const std::vector<double>& expected,
                         const std::vector<Index>& hollow) {
    for (std::size_t r = 0; r < expected.size(); ++r) {
        if (!is_meshed_region(static_cast<Index>(r), hollow)) continue;
        const double got = r < quality.region_volume_mm3.size() ? quality.region_volume_mm3[r] : 0;
        if (!(std::abs(got - expected[r]) <= mesh_volume_tolerance * expected[r]))
            return fmt::format("region {} has {:.0f} mm3 instead of {:.0f}", r, got, expected[r]);
    }
    return {};
}

}  // namespace

bool is_meshed_region(Index region, const std::vector<Index>& hollow) {
    return region != outside_region &&
           std::find(hollow.begin(), hollow.end(), region) == hollow.end();
}

std::vector<double> enclosed_volumes(const RegionSurface& surface, Index num_regions) {
    std::vector<double> volume(static_cast<std::size_t>(num_regions), 0.0);
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        const Triangle& t = surface.triangles[i];
        const double part =
            tet_volume(surface.vertices[surface.triangles[0][0]], surface.vertices[t[0]],
                       surface.vertices[t[1]], surface.vertices[t[2]]);
        volume[surface.regions[i][0]] += part;
        volume[surface.regions[i][1]] -= part;
    }
    if (!volume.empty()) volume[outside_region] = 0;
    return volume;
}

std::vector<double> voxel_volumes(const RegionImage& image, Index num_regions) {
    std::vector<double> volume(static_cast<std::size_t>(num_regions), 0.0);
    for (std::uint8_t region : image.voxels)
        if (region < num_regions) volume[region] += image.grid.voxel_volume();
    if (!volume.empty()) volume[outside_region] = 0;
    return volume;
}

bool has_valid_indices(const RegionMesh& mesh) {
    const Index count = mesh.mesh.num_nodes();
    const auto valid = [&](const auto& element) {
        return std::all_of(element.begin(), element.end(),
                           [&](Index n) { return n >= 0 && n < count; });
    };
    return mesh.mesh.region.size() == mesh.mesh.tets.size() &&
           mesh.surface.regions.size() == mesh.surface.triangles.size() &&
           std::all_of(mesh.mesh.tets.begin(), mesh.mesh.tets.end(), valid) &&
           std::all_of(mesh.surface.triangles.begin(), mesh.surface.triangles.end(), valid) &&
           std::all_of(mesh.mesh.nodes.begin(), mesh.mesh.nodes.end(),
                       [](const Vec3& node) { return node.allFinite(); });
}

std::string why_unusable(const RegionMesh& mesh, const MeshQuality& quality,
                         const std::vector<double>& expected_mm3,
                         const std::vector<Index>& hollow) {
    if (mesh.mesh.tets.empty()) return "it has no tets";
    if (quality.num_inverted > 0) return fmt::format("{} tets are inverted", quality.num_inverted);
    if (!(quality.min_dihedral_deg >= mesh_min_dihedral_deg))
        return fmt::format("its smallest dihedral angle is {:.1f} degrees, below {:.0f}",
                           quality.min_dihedral_deg, mesh_min_dihedral_deg);
    if (const Index unused = num_unused_nodes(mesh.mesh); unused > 0)
        return fmt::format("{} nodes belong to no tet", unused);
    if (const Index region = open_region(mesh.surface, hollow); region >= 0)
        return fmt::format("the surface of region {} is open", region);
    return wrong_volume(quality, expected_mm3, hollow);
}

}  // namespace palpate

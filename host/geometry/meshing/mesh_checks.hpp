// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/geometry/meshing/mesh_quality.hpp"
#include "host/geometry/meshing/region_mesh.hpp"
#include "host/io/label_image.hpp"

namespace palpate {

constexpr double mesh_volume_tolerance = 0.05;
constexpr double mesh_min_dihedral_deg = 5.0;

bool is_meshed_region(Index region, const std::vector<Index>& hollow);

/// Volume enclosed by each region's surface, by region number (mm^3); of 0 (outside) it is 0.
std::vector<double> enclosed_volumes(const RegionSurface& surface, Index num_regions);

/// Volume of each region's voxels, by region number (mm^3).
std::vector<double> voxel_volumes(const RegionImage& image, Index num_regions);

/// Why a mesh must not be used, in a few words; empty if it may. Checks indices, inverted tets, the
/// smallest dihedral angle, unused nodes, that every meshed region's surface is closed, and
/// the volume of each meshed region against `expected_mm3`.
std::string why_unusable(const RegionMesh& mesh, const MeshQuality& quality,
                         const std::vector<double>& expected_mm3, const std::vector<Index>& hollow);

/// Whether all indices are within range: the first check of a mesh that comes from elsewhere.
bool has_valid_indices(const RegionMesh& mesh);

}  // namespace palpate

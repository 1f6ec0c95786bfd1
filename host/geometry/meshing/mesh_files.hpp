// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "host/geometry/meshing/mesher.hpp"

namespace palpate {

/// Point and cell arrays that travel with a mesh into a .vtu file.
struct MeshArrays {
    std::map<std::string, std::vector<double>> point_scalars;  ///< [num_nodes]
    std::map<std::string, std::vector<Vec3>> point_vectors;    ///< [num_nodes]
    std::map<std::string, std::vector<double>> cell_scalars;   ///< [num_tets]
};

/// Writes .vtu (appended, compressed), with field data SPACE = LPS. Cell array `region_name` holds
/// the mesh regions.
void write_vtu(const std::filesystem::path& path, const Mesh& mesh, const MeshArrays& arrays,
               const std::string& region_name = "region");

/// Reads a tetrahedral mesh from .vtu or legacy .vtk with an integer cell array `region_name` of
/// file labels (not region numbers) into `Mesh::region`. Inverted tets are turned round.
/// Throws Error(input_unreadable) (missing, damaged), Error(input_unusable) (no tets, no array).
Mesh read_vtu(const std::filesystem::path& path, const std::string& region_name = "region",
              MeshArrays* arrays = nullptr);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// A SolidMesh as files have it: `mesh.region` holds file labels, not region numbers.
struct SolidMeshFile {
    SolidMesh mesh;
    std::map<std::string, std::vector<double>> point_scalars;  ///< [num_nodes]
};

/// Reads .vtu or legacy .vtk. In space tetrahedra are taken (linear or quadratic, one kind), in a
/// plane triangles (linear or quadratic) or linear quadrilaterals; cells of lower dimension and
/// points of no cell are left out, elements that are inside out are turned round.
///   region_name   integer cell array of labels; without a name "region" if there is one, else
///                 every element has label 1
/// Throws Error(input_unreadable) (missing, damaged), Error(input_unusable) (no such cells, several
/// kinds, no such array).
SolidMeshFile read_solid_mesh(const std::filesystem::path& path, Formulation formulation,
                              const std::optional<std::string>& region_name);

/// What is known of a SolidMesh in one state.
struct SolidMeshArrays {
    std::map<std::string, std::vector<double>> point_scalars;  ///< [num_nodes]
    std::map<std::string, std::vector<Vec3>> point_vectors;    ///< [num_nodes]
    std::map<std::string, std::vector<double>> cell_scalars;   ///< [num_elements]
    /// [num_elements] xx, yy, zz, xy, yz, xz
    std::map<std::string, std::vector<std::array<double, 6>>> cell_tensors;
};

/// Writes .vtu (appended, compressed), with field data SPACE = LPS. Cell array "region" holds
/// `mesh.region`. Throws Error(output_failed).
void write_solid_mesh(const std::filesystem::path& path, const SolidMesh& mesh,
                      const SolidMeshArrays& arrays);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/meshing/mesh_quality.hpp"
#include "host/geometry/meshing/region_mesh.hpp"
#include "solver/base/log.hpp"

namespace palpate {

enum class MesherKind { automatic, tetgen, cgal };

struct MesherOptions {
    MesherKind kind = MesherKind::automatic;  ///< TetGen first, CGAL if it fails or is absent
    Index num_nodes = 6000;                   ///< wanted number of nodes; met within about 20 %
    double edge_length_mm = 3.0;  ///< on organ surfaces (CGAL; TetGen keeps the surface given)
    double outer_edge_length_mm = 12.0;  ///< largest edge, far from organs
    double time_limit_s = 120;           ///< of the child process
    double memory_limit_gib = 8;
    std::filesystem::path program;  ///< palpate-mesh; empty: beside the running program, then PATH
};

struct MesherSummary {
    std::string mesher;    ///< "TetGen 1.5.0", "CGAL 5.5.1"
    std::string fallback;  ///< why the first mesher was not used, empty if it was
    MeshQuality quality;
    double seconds = 0;
};

/// Meshes the inside of every region but those in `hollow` (and outside) in a child process with
/// time and memory limits; checks that volumes agree with the surface within 5 %, that no element
/// is inverted and that the smallest dihedral angle is at least 5 degrees before it returns.
///   surface  from `extract_surfaces`; TetGen keeps its triangles
///   image, field  the label volume, for the CGAL mesher (which makes its own surface)
/// Throws Error(mesh_failed) with each mesher's reason, Error(time_limit).
RegionMesh make_mesh(const RegionSurface& surface, const RegionImage& image,
                     const LabelField& field, const std::vector<Index>& hollow,
                     const MesherOptions& options, MesherSummary* summary = nullptr,
                     const ProgressSink& progress = {});

/// Whether the optional program `palpate-mesh` can be found, and which meshers it holds.
std::vector<std::string> available_meshers(const std::filesystem::path& program = {});

}  // namespace palpate

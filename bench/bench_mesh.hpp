// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "solver/linear/linear_solver.hpp"

namespace palpate::bench {

/// What a benchmark solves: a model and the displacement of its prescribed dofs.
struct BenchMesh {
    std::string name;  ///< "pelvis_18k"
    Model model;
    Columns prescribed_mm;  ///< [num_dofs, 1], 0 at free dofs
};

/// One file, little-endian: magic "PALPMESH", version, counts, then the arrays without gaps:
///   nodes [num_nodes, 3] fp64 mm; prescribed_mm [num_nodes, 3] fp64; materials [num_materials, 2]
///   fp64 (kPa, Poisson's ratio); tets [num_tets, 4] int32; region [num_tets] int32;
///   prescribed [num_nodes, 3] uint8
/// Written under another name, then renamed. Throws Error(output_failed).
void write_bench_mesh(const std::filesystem::path& path, const BenchMesh& mesh);

/// Throws Error(input_unreadable) for a file that is missing, cut off, too long or of another kind,
/// and what `check_model` throws. The name is the file's, without its ending.
BenchMesh read_bench_mesh(const std::filesystem::path& path);

/// The sizes that the benchmarks run: "box" is made on the spot and always there, the others are
/// files of the folder.
const std::vector<std::string>& bench_mesh_names();

/// Takes `--meshes=FOLDER` out of the arguments, or else the environment variable
/// PALPATE_BENCH_MESHES; empty if neither is given.
std::filesystem::path take_mesh_folder(int& argc, char** argv);

/// The mesh of that name, kept until another is asked for: one mesh is in memory at a time. Throws
/// what `read_bench_mesh` throws, saying how to make the file if it is missing.
const BenchMesh& bench_mesh(const std::filesystem::path& folder, const std::string& name);

}  // namespace palpate::bench

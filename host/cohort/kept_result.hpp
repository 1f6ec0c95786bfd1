// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "host/apps/recover/pipeline/compact_result.hpp"
#include "host/cohort/cohort_plan.hpp"

namespace palpate {

/// Writes what `keep` says of a result into the folder `inside`. Compact: result.json;
/// displacement.npy, float32 [nodes, 3] mm; force.npy, float32 [held nodes, 3] mN, LPS; facts.gz,
/// from which and the patient's mesh `expand` makes the rest.
void write_kept_result(const RecoveryResult& result, KeptFiles keep,
                       const std::filesystem::path& inside);

/// Makes, unless it is there, the mesh that these refer to: mesh-<hash>.vtu in the folder
/// `reference`, with labels in the cell array "region" and "held" (0 free, 1 fixed, 2 driven) at
/// its nodes; held nodes are those above 0, in order. Beside it lies `body`, the bytes of the mesh
/// with its surface, as body-<hash>.gz. Returns the first file's name.
std::string keep_mesh(const RecoveryResult& result, const std::string& body,
                      const std::filesystem::path& reference);
/// "body-<hash>.gz" of "mesh-<hash>.vtu".
std::string body_name_of(const std::string& mesh_name);

/// What was kept of a case. Throws Error(input_unreadable) naming the file.
CompactResult read_compact_result(const std::filesystem::path& case_folder,
                                  const std::filesystem::path& body);

/// A file of NumPy's format (version 1.0): float32 [rows, 3], little endian.
std::string npy_of(const std::vector<Vec3>& rows);
/// The rows of what `npy_of` wrote. Throws Error(input_unreadable), without file name.
std::vector<Vec3> rows_of_npy(const std::string& file);

}  // namespace palpate

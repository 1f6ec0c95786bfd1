// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "host/apps/recover/result/recovery_result.hpp"
#include "host/cohort/cohort_plan.hpp"

namespace palpate {

/// Writes what `keep` says of a result into the folder `inside`. Compact: result.json;
/// displacement.npy, float32 [nodes, 3] mm; force.npy, float32 [held nodes, 3] mN, LPS.
void write_kept_result(const RecoveryResult& result, KeptFiles keep,
                       const std::filesystem::path& inside);

/// Makes, unless it is there, the mesh that these refer to: mesh-<hash>.vtu in the folder
/// `reference`, with labels in the cell array "region" and "held" (0 free, 1 fixed, 2 driven) at
/// its nodes; held nodes are those above 0, in order. Returns the file's name.
std::string keep_mesh(const RecoveryResult& result, const std::filesystem::path& reference);

/// A file of NumPy's format (version 1.0): float32 [rows, 3], little endian.
std::string npy_of(const std::vector<Vec3>& rows);

}  // namespace palpate

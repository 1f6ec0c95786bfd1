// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// Writes the mesh as .vtu, LPS mm: cell arrays `region` (labels of the input file) and
/// `stiffness_kpa`; point arrays `displacement` (mm, reference to aligned target), `force` (mN) and
/// `held` (0 free, 1 fixed, 2 moved by a driven organ).
/// Throws Error(output_failed).
void write_vtk_report(const RecoveryResult& result, const std::filesystem::path& path);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/recover/result/recovery_result.hpp"
#include "host/geometry/warping/field_files.hpp"
#include "host/page/result_tree.hpp"

namespace palpate {

/// What a recovery found, but for the fields on mesh and grid: what result.json, the report, the
/// terminal, C and Python tell of it. Units are in the names. Holds no path, and no file name
/// unless asked. `fields`: which displacement fields lie beside the file.
ResultTree recovery_tree(const RecoveryResult& result, bool include_file_names = false,
                         FieldChoice fields = FieldChoice::one);

/// The regions alone, a part for each; likewise the surfaces.
ResultTree regions_tree(const std::vector<RegionResult>& regions);
ResultTree surfaces_tree(const RecoveryResult& result);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/result/recovery_result.hpp"
#include "host/geometry/warping/field_files.hpp"

namespace palpate {

/// result.json: everything but the fields on mesh and grid, UTF-8, keys in a fixed order. Units are
/// in the names; numbers that are not finite are null. Holds no path, and no file name unless
/// asked. `fields`: which displacement fields lie beside it.
std::string json_report(const RecoveryResult& result, bool include_file_names = false,
                        FieldChoice fields = FieldChoice::one);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate {

/// Throws Error(output_failed) if `path` is a folder, or is there and may not be replaced.
void check_output_file(const std::filesystem::path& path, bool overwrite);

}  // namespace palpate

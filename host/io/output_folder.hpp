// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace palpate {

/// Throws Error(output_failed) if `write_folder_atomically` would refuse `folder`, or if it exists
/// without a file `mark`, which tells folders of palpate from others.
void check_output_folder(const std::filesystem::path& folder, const char* mark, bool overwrite);

/// Makes `folder` in one step: `fill` writes into a temporary sibling, every file is brought to
/// disk (fsync), the sibling is renamed. If anything throws, the sibling is removed and nothing
/// changed. Used for everything palpate writes as a folder. Throws Error(output_failed).
void write_folder_atomically(const std::filesystem::path& folder, bool overwrite,
                             const std::function<void(const std::filesystem::path&)>& fill);

/// Writes one text file and checks every step. Throws Error(output_failed).
void write_text_file(const std::filesystem::path& path, const std::string& text);

/// Makes a folder and what is missing above it. Throws Error(output_failed).
void make_folders(const std::filesystem::path& folder);

}  // namespace palpate

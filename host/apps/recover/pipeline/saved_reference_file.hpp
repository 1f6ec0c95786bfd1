// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "host/apps/recover/pipeline/saved_reference.hpp"

namespace palpate {

/// Throws Error(output_failed) if `write_saved_reference` would fail or would replace a file that
/// it should not: any without `overwrite`, and any that it did not write itself. Call it before a
/// long computation.
void check_saved_reference_path(const std::filesystem::path& path, bool overwrite);

/// One binary file in the byte order of this machine: 8 bytes of magic, byte order mark and format
/// version (32 bits each), size and FNV-1a hash of the content (64 bits each), content. It gets its
/// name when it is complete. Throws Error(output_failed).
void write_saved_reference(SavedReference saved, const std::filesystem::path& path);

/// Throws Error(input_unreadable) if the file is missing, foreign, cut off or damaged. Memory:
/// about twice the size of the file.
SavedReference read_saved_reference(const std::filesystem::path& path);

/// What is behind the header of such a file, whose hash was compared. Throws
/// Error(input_unreadable).
SavedReference parse_saved_content(std::span<const char> content);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Device code of one program as the driver gave it.
using ProgramBinary = std::vector<unsigned char>;

/// A folder of compiled programs. Each entry repeats its complete key and carries a checksum, so a
/// damaged, truncated or colliding file is never handed to the driver. Files are written under a
/// temporary name and renamed: processes may share the folder. A folder that cannot be written is
/// no error: nothing is kept then.
class ProgramFolder {
public:
    explicit ProgramFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// The stored code for `key`, or nothing. A bad entry is removed.
    std::optional<ProgramBinary> read(std::string_view key) const;
    void write(std::string_view key, const ProgramBinary& binary) const;
    void remove(std::string_view key) const;
    /// Where the entry of `key` is kept.
    std::filesystem::path path_of(std::string_view key) const;

private:
    std::filesystem::path folder_;  ///< empty: keeps nothing
};

/// $PALPATE_CACHE_DIR, else $XDG_CACHE_HOME/palpate, else ~/.cache/palpate, else empty.
std::filesystem::path default_cache_folder();

}  // namespace palpate

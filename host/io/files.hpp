// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "solver/base/locked_folder.hpp"

namespace palpate {

/// A folder that only this user can read; removed with its content at the end, or by the next
/// process that makes one, if this one is killed: volumes of patients may be in it. Throws
/// Error(output_failed) if none can be made.
class PrivateFolder {
public:
    PrivateFolder();
    const std::filesystem::path& path() const { return folder_.path(); }

private:
    LockedFolder folder_;
};

/// Why a file cannot be read, in words, or nothing if it can: missing, no file, empty, no
/// permission.
std::optional<std::string> why_unreadable(const std::filesystem::path& path);

/// A file that is made beside its place and put there at the end: a reader never sees half of it.
/// What processes that were killed while they made this file left behind is removed first. All
/// throw Error(output_failed) naming the file.
class UnfinishedFile {
public:
    explicit UnfinishedFile(std::filesystem::path path);
    /// Lets `write` write a file of the same name in a hidden, locked folder beside it, and makes
    /// that durable. `write` may throw anything derived from std::exception.
    void write(const std::function<void(const std::filesystem::path& temporary)>& write);
    /// Moves it to its place. Without that nothing remains of it.
    void finish();

private:
    std::filesystem::path path_, parent_;
    std::optional<LockedFolder> folder_;
};

/// Writes and finishes one UnfinishedFile.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace palpate {

/// A folder that only this user can read; removed with its content at the end.
/// Throws Error(output_failed) if none can be made.
class PrivateFolder {
public:
    PrivateFolder();
    ~PrivateFolder();
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// Why a file cannot be read, in words, or nothing if it can: missing, no file, empty, no
/// permission.
std::optional<std::string> why_unreadable(const std::filesystem::path& path);

/// How the names of unfinished files and folders of this process begin:
/// ".unfinished-<host>-<process>-". Whoever ends the process early knows them by it.
std::string unfinished_prefix();

/// Lets `write` write a temporary file in the folder of `path` (same ending), makes it durable and
/// gives it its final name: a reader never sees half a file.
/// Throws Error(output_failed) naming the file; `write` may throw anything derived from
/// std::exception.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace palpate {

/// A folder "<prefix><host>-<process>-<letters>" for work in progress, removed with all it holds
/// unless `keep` is called; a forked child leaves it to its parent. It is locked as long as its
/// process lives: what a killed process left behind under the same prefix is removed first, what
/// another one works in is not, on whatever machine. Where a file system has no locks, nothing of
/// others is removed. Throws Error(output_failed) if none can be made.
class LockedFolder {
public:
    enum class Readers { owner, everybody };
    LockedFolder(const std::filesystem::path& parent, const std::string& prefix, Readers readers);
    ~LockedFolder();
    LockedFolder(const LockedFolder&) = delete;
    LockedFolder& operator=(const LockedFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    void keep();

private:
    bool claim();

    std::filesystem::path path_;
    pid_t owner_ = 0;
    int lock_ = -1;  ///< the open folder
};

/// Removes the folders under this prefix that no living process holds, where that can be known.
void remove_left_behind(const std::filesystem::path& parent, const std::string& prefix);

/// Removes every LockedFolder of this process, the youngest first, also under the hands of threads
/// that still write into it: none can give it a final name any more. For the end of a program.
void remove_folders_in_progress();

}  // namespace palpate

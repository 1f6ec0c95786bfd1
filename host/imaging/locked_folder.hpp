// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// "<host>-<process>-": part of the names of all unfinished files and folders of this process.
std::string process_mark();

/// A folder "<prefix><process mark><number>" for work in progress, removed with all it holds unless
/// `keep` is called. It is locked as long as its process lives: what a killed process left behind
/// under the same prefix is removed first, what another one works in is not, on whatever machine.
/// Throws Error(output_failed) if none can be made.
class LockedFolder {
public:
    enum class Readers { owner, everybody };
    LockedFolder(const std::filesystem::path& parent, const std::string& prefix, Readers readers);
    ~LockedFolder();
    LockedFolder(const LockedFolder&) = delete;
    LockedFolder& operator=(const LockedFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    void keep() { path_.clear(); }

private:
    std::filesystem::path path_;
    int lock_ = -1;  ///< the open folder
};

}  // namespace palpate

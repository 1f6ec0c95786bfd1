// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/pocl_environment.hpp"

#include <stdlib.h>
#include <sys/statvfs.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "solver/backends/opencl/program_file.hpp"
#include "solver/base/error.hpp"
#include "solver/base/locked_folder.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

const std::string folder_prefix = "palpate-pocl-cache-";

/// Of this process; none before it is made and where it cannot be made.
std::unique_ptr<LockedFolder>& private_folder() {
    static auto* folder = new std::unique_ptr<LockedFolder>;  // outlives every exit handler
    return *folder;
}

void remove_private_folder() { private_folder().reset(); }

/// PoCL brings every file to disk, which takes a third of a second on a busy one: better a file
/// system in memory, if it has room and lets code be loaded from it.
bool is_good_memory(const char* path) {
    constexpr unsigned long long enough = 64ull << 20;
    struct statvfs system {};
    return statvfs(path, &system) == 0 && !(system.f_flag & ST_NOEXEC) &&
           1ull * system.f_bavail * system.f_frsize >= enough;
}

/// Where a private folder may be made, best first.
std::vector<fs::path> places() {
    std::vector<fs::path> found;
    if (is_good_memory("/dev/shm")) found.push_back("/dev/shm");
    std::error_code failed;
    const fs::path usual = fs::temp_directory_path(failed);
    if (!failed) found.push_back(usual);
    for (const char* other : {"/tmp", "/var/tmp"}) found.push_back(other);
    if (const fs::path cache = default_cache_folder(); !cache.empty()) found.push_back(cache);
    return found;
}

/// Also removes, in every place, what processes that were killed left behind.
void make_private_folder() {
    if (getenv("POCL_CACHE_DIR")) return;
    for (const fs::path& parent : places()) {
        remove_left_behind(parent, folder_prefix);
        if (private_folder()) continue;
        try {
            private_folder() =
                std::make_unique<LockedFolder>(parent, folder_prefix, LockedFolder::Readers::owner);
        } catch (const Error&) {
            continue;
        }
    }
    if (!private_folder()) return;  // PoCL then uses its own default
    setenv("POCL_CACHE_DIR", private_folder()->path().c_str(), 1);
    std::atexit(remove_private_folder);
    std::at_quick_exit(remove_private_folder);
}

}  // namespace

void prepare_pocl_environment() {
    static std::once_flag once;
    std::call_once(once, [] {
        make_private_folder();
        setenv("POCL_WORK_GROUP_SPECIALIZATION", "0", 0);  // keeps what the user has set
    });
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/pocl_environment.hpp"

#include <signal.h>
#include <stdlib.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "solver/backends/opencl/program_file.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

const std::string folder_prefix = "palpate-pocl-";

struct PrivateFolder {
    std::string path;
    pid_t owner = 0;  ///< a forked child must not remove its parent's folder
};

PrivateFolder& private_folder() {
    static PrivateFolder* folder = new PrivateFolder;  // outlives every exit handler
    return *folder;
}

void remove_private_folder() {
    const PrivateFolder& folder = private_folder();
    std::error_code ignored;
    if (folder.owner == getpid()) fs::remove_all(folder.path, ignored);
}

// "palpate-pocl-<pid>-XXXXXX" whose process is gone was left behind by a crash.
bool is_left_behind(const std::string& name) {
    if (name.rfind(folder_prefix, 0) != 0) return false;
    const long pid = std::strtol(name.c_str() + folder_prefix.size(), nullptr, 10);
    return pid > 0 && kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH;
}

void remove_folders_left_behind(const fs::path& parent) {
    std::error_code ignored;
    for (fs::directory_iterator it(parent, ignored), end; it != end; it.increment(ignored)) {
        if (ignored) return;
        std::error_code not_ours;
        if (is_left_behind(it->path().filename().string())) fs::remove_all(it->path(), not_ours);
    }
}

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

void make_private_folder() {
    if (getenv("POCL_CACHE_DIR")) return;
    for (const fs::path& parent : places()) {
        remove_folders_left_behind(parent);
        if (!private_folder().path.empty()) continue;
        std::string path =
            (parent / (folder_prefix + std::to_string(getpid()) + "-XXXXXX")).string();
        if (mkdtemp(path.data())) private_folder() = {path, getpid()};
    }
    if (private_folder().path.empty()) return;  // PoCL then uses its own default
    setenv("POCL_CACHE_DIR", private_folder().path.c_str(), 1);
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

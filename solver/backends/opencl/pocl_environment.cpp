// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/pocl_environment.hpp"

#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <string>

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

void make_private_folder() {
    if (getenv("POCL_CACHE_DIR")) return;
    std::error_code failed;
    const fs::path parent = fs::temp_directory_path(failed);
    if (failed) return;
    remove_folders_left_behind(parent);
    std::string path = (parent / (folder_prefix + std::to_string(getpid()) + "-XXXXXX")).string();
    if (!mkdtemp(path.data())) return;  // PoCL then uses its own default
    private_folder() = {path, getpid()};
    setenv("POCL_CACHE_DIR", path.c_str(), 1);
    std::atexit(remove_private_folder);
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

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cli/scratch.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace palpate {
namespace {

namespace fs = std::filesystem;

const std::string scratch_prefix = "palpate-run-";
const std::string lock_name = "in-use";

/// Of this program; empty if it has none.
struct Scratch {
    fs::path folder;
    pid_t owner = 0;  ///< a forked child must not remove its parent's folder
};

Scratch& scratch() {
    static auto* one = new Scratch;  // outlives every exit handler
    return *one;
}

/// The open file keeps a lock for as long as the program lives, however it ends.
bool hold_lock(const fs::path& folder) {
    const int file = open((folder / lock_name).c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    return file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0;
}

bool is_left_behind(const fs::path& folder) {
    if (!folder.filename().string().starts_with(scratch_prefix)) return false;
    const int file = open((folder / lock_name).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) return false;  // being made at this moment, or not ours
    const bool is_free = flock(file, LOCK_EX | LOCK_NB) == 0;
    close(file);
    return is_free;
}

void remove_those_left_behind(const fs::path& parent) {
    std::error_code ignored;
    for (fs::directory_iterator it(parent, ignored), end; !ignored && it != end;
         it.increment(ignored)) {
        if (is_left_behind(it->path())) remove_persistently(it->path());
    }
}

}  // namespace

void make_scratch() {
    std::error_code failed;
    const fs::path parent = fs::temp_directory_path(failed);
    if (failed) return;
    remove_those_left_behind(parent);
    std::string name = (parent / (scratch_prefix + "XXXXXX")).string();
    if (!mkdtemp(name.data())) return;
    scratch() = {name, getpid()};
    if (!hold_lock(name)) return remove_scratch();
    setenv("TMPDIR", name.c_str(), 1);
    std::atexit(remove_scratch);
}

void remove_scratch() {
    if (!scratch().folder.empty() && scratch().owner == getpid())
        remove_persistently(scratch().folder);
}

void remove_persistently(const fs::path& path) {
    constexpr int attempts = 50;
    for (int k = 0; k < attempts; ++k) {
        std::error_code failed;
        fs::remove_all(path, failed);
        if (!failed && !fs::exists(fs::symlink_status(path, failed))) return;
        usleep(2000);
    }
}

}  // namespace palpate

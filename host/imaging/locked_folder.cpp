// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/imaging/locked_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <random>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr int most_attempts = 100;

/// The folder, opened and locked; -1 if another process holds it or it cannot be locked.
int lock_folder(const fs::path& path) {
    const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0 || ::flock(folder, LOCK_EX | LOCK_NB) == 0) return folder;
    ::close(folder);
    return -1;
}

/// Whether `path` still is the open folder: another process may have taken it for left behind.
bool is_still_there(const fs::path& path, int folder) {
    struct stat named = {}, opened = {};
    return ::stat(path.c_str(), &named) == 0 && ::fstat(folder, &opened) == 0 &&
           named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
}

void remove_left_behind(const fs::path& parent, const std::string& prefix) {
    std::vector<fs::path> found;
    std::error_code ignored;
    for (fs::directory_iterator it(parent, ignored), end; !ignored && it != end;
         it.increment(ignored))
        if (it->path().filename().string().starts_with(prefix)) found.push_back(it->path());
    for (const fs::path& path : found) {
        const int lock = lock_folder(path);
        if (lock < 0) continue;
        fs::remove_all(path, ignored);
        ::close(lock);
    }
}

std::string random_name() {
    constexpr char letters[] = "0123456789abcdefghijklmnopqrstuvwxyz";
    std::random_device random;
    std::string name;
    for (int k = 0; k < 10; ++k) name += letters[random() % (sizeof letters - 1)];
    return name;
}

}  // namespace

std::string process_mark() {
    char host[65] = "";
    if (gethostname(host, sizeof host - 1) != 0) host[0] = 0;
    return std::string(host) + "-" + std::to_string(getpid()) + "-";
}

LockedFolder::LockedFolder(const fs::path& parent, const std::string& prefix, Readers readers) {
    remove_left_behind(parent, prefix);
    int reason = 0;
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
        path_ = parent / (prefix + process_mark() + random_name());
        if (::mkdir(path_.c_str(), readers == Readers::owner ? 0700 : 0777) != 0) {
            reason = errno;
            if (reason != EEXIST && reason != EINTR) break;
            continue;
        }
        lock_ = lock_folder(path_);
        if (lock_ < 0 || is_still_there(path_, lock_)) return;  // without locks nobody removes it
        ::close(lock_);
        lock_ = -1;
    }
    path_.clear();
    throw Error(ErrorCode::output_failed, "no folder can be made in '" + parent.string() + "' (" +
                                              std::strerror(reason) +
                                              "); check free space and permissions");
}

LockedFolder::~LockedFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
    if (lock_ >= 0) ::close(lock_);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/base/locked_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <random>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr int most_attempts = 100;

/// The folders of this process; they outlive every exit handler.
struct InProgress {
    std::mutex mutex;
    std::vector<fs::path> folders;
};

InProgress& in_progress() {
    static auto* all = new InProgress;
    return *all;
}

void remember(const fs::path& path) {
    const std::lock_guard lock(in_progress().mutex);
    in_progress().folders.push_back(path);
}

void forget(const fs::path& path) {
    const std::lock_guard lock(in_progress().mutex);
    auto& folders = in_progress().folders;
    folders.erase(std::remove(folders.begin(), folders.end(), path), folders.end());
}

int open_folder(const fs::path& path) {
    return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

enum class Lock { ours, of_another, unsupported };

Lock try_to_lock(int folder) {
    while (::flock(folder, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        for (const int reason : {ENOLCK, ENOTSUP, EBADF, ENOSYS, EINVAL})
            if (errno == reason) return Lock::unsupported;
        return Lock::of_another;
    }
    return Lock::ours;
}

/// Whether `path` still is the open folder: another process may have taken it for left behind.
bool is_still_there(const fs::path& path, int folder) {
    struct stat named = {}, opened = {};
    return ::stat(path.c_str(), &named) == 0 && ::fstat(folder, &opened) == 0 &&
           named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
}

/// Again and again while something appears in it.
void remove_persistently(const fs::path& path) {
    constexpr int attempts = 50;
    for (int k = 0; k < attempts; ++k) {
        std::error_code failed;
        fs::remove_all(path, failed);
        if (!failed && !fs::exists(fs::symlink_status(path, failed))) return;
        usleep(2000);
    }
}

/// Takes away the name first, so that no half of it can still get its final one.
void discard(const fs::path& path) {
    const fs::path aside = path.string() + "-cancelled";
    if (std::rename(path.c_str(), aside.c_str()) == 0) remove_persistently(aside);
}

std::string random_name() {
    constexpr char letters[] = "0123456789abcdefghijklmnopqrstuvwxyz";
    std::random_device random;
    std::string name;
    for (int k = 0; k < 10; ++k) name += letters[random() % (sizeof letters - 1)];
    return name;
}

std::string process_mark() {
    char host[65] = "";
    if (gethostname(host, sizeof host - 1) != 0) host[0] = 0;
    return std::string(host) + "-" + std::to_string(getpid()) + "-";
}

}  // namespace

void remove_left_behind(const fs::path& parent, const std::string& prefix) {
    std::vector<fs::path> found;
    std::error_code ignored;
    for (fs::directory_iterator it(parent, ignored), end; !ignored && it != end;
         it.increment(ignored))
        if (it->path().filename().string().starts_with(prefix)) found.push_back(it->path());
    for (const fs::path& path : found) {
        const int folder = open_folder(path);
        if (folder < 0) continue;
        if (try_to_lock(folder) == Lock::ours) fs::remove_all(path, ignored);
        ::close(folder);
    }
}

LockedFolder::LockedFolder(const fs::path& parent, const std::string& prefix, Readers readers)
    : owner_(getpid()) {
    remove_left_behind(parent, prefix);
    int reason = 0;
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
        path_ = parent / (prefix + process_mark() + random_name());
        if (::mkdir(path_.c_str(), readers == Readers::owner ? 0700 : 0777) != 0) {
            reason = errno;
            if (reason != EEXIST && reason != EINTR) break;
        } else if (claim()) {
            remember(path_);
            return;
        } else {
            reason = errno;
            ::rmdir(path_.c_str());
        }
    }
    throw Error(ErrorCode::output_failed, "no folder can be made in '" + parent.string() + "' (" +
                                              std::strerror(reason) +
                                              "); check free space and permissions");
}

/// Opens and locks the new folder. False, with errno, if it cannot be opened or if another process
/// was faster and takes it for left behind.
bool LockedFolder::claim() {
    lock_ = open_folder(path_);
    if (lock_ < 0) return false;
    if (try_to_lock(lock_) != Lock::of_another && is_still_there(path_, lock_)) return true;
    ::close(lock_);
    lock_ = -1;
    errno = EBUSY;
    return false;
}

LockedFolder::~LockedFolder() {
    if (!path_.empty() && owner_ == getpid()) {
        remove_persistently(path_);
        forget(path_);
    }
    if (lock_ >= 0) ::close(lock_);
}

void LockedFolder::keep() {
    forget(path_);
    path_.clear();
}

void remove_folders_in_progress() {
    const std::lock_guard lock(in_progress().mutex);
    auto& folders = in_progress().folders;
    for (; !folders.empty(); folders.pop_back()) discard(folders.back());
}

}  // namespace palpate

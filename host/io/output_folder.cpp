// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/output_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "solver/base/error.hpp"
#include "solver/base/locked_folder.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& remedy) {
    throw Error(ErrorCode::output_failed, fmt::format("{}: {}; {}", path.string(), what, remedy));
}

[[noreturn]] void fail_with_errno(const fs::path& path, const std::string& what) {
    fail(path, fmt::format("{} ({})", what, std::strerror(errno)),
         "check free space and permissions, or choose another folder with --out");
}

/// Opens, brings the content to disk, closes. Works for files and for folders.
void sync_to_disk(const fs::path& path) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) fail_with_errno(path, "cannot be opened again to bring it to disk");
    int status = 0;
    while ((status = ::fsync(fd)) != 0 && errno == EINTR) {
    }
    const int reason = errno;
    ::close(fd);
    errno = reason;
    const bool good = status == 0 || reason == EINVAL;  // EINVAL: a file system without fsync
    if (!good) fail_with_errno(path, "cannot be brought to disk");
}

/// False, with errno, if not every byte could be written.
bool write_all(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(file, text.data(), text.size());
        if (written < 0 && errno != EINTR) return false;
        if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

void sync_tree_to_disk(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) sync_to_disk(entry.path());
    sync_to_disk(folder);
}

/// The folder as an absolute path without "." parts and trailing slash; links are followed.
fs::path resolved(const fs::path& folder) {
    fs::path path = fs::weakly_canonical(fs::absolute(folder));
    if (path.filename().empty()) path = path.parent_path();
    if (path == path.root_path()) fail(folder, "not a folder that can be made", "choose another");
    return path;
}

/// Missing parents of the target; those that were made are removed again unless `keep` is called.
class Parents {
public:
    explicit Parents(const fs::path& target) {
        for (fs::path p = target.parent_path(); !fs::exists(p); p = p.parent_path())
            made_.push_back(p);
        std::error_code failed;
        fs::create_directories(target.parent_path(), failed);
        errno = failed.value();
        if (failed) fail_with_errno(target.parent_path(), "cannot be made");
    }
    ~Parents() {
        std::error_code ignored;
        for (const fs::path& p : made_) fs::remove(p, ignored);  // only if empty
    }
    void keep() { made_.clear(); }

private:
    std::vector<fs::path> made_;
};

/// Puts `fresh` in the place of `old` in one step, and the old one where `fresh` was.
void exchange(const fs::path& fresh, const fs::path& old) {
    if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, old.c_str(), RENAME_EXCHANGE) == 0) return;
    if (errno != EINVAL && errno != ENOSYS) fail_with_errno(old, "cannot be replaced");
    // A file system without exchange: away with the old one, and back with it if that fails.
    const fs::path aside = fresh.string() + "-old";
    if (std::rename(old.c_str(), aside.c_str()) != 0) fail_with_errno(old, "cannot be replaced");
    if (std::rename(fresh.c_str(), old.c_str()) != 0) {
        const int reason = errno;
        std::rename(aside.c_str(), old.c_str());
        errno = reason;
        fail_with_errno(old, "cannot be replaced");
    }
    std::rename(aside.c_str(), fresh.c_str());
}

/// Renames to a name that nobody has taken meanwhile.
void rename_to_new(const fs::path& from, const fs::path& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return;
    const bool unsupported = errno == EINVAL || errno == ENOSYS;
    if (unsupported && !fs::exists(to) && std::rename(from.c_str(), to.c_str()) == 0) return;
    fail_with_errno(to, "cannot be made");
}

/// Runs `action`; what the file system throws becomes Error(output_failed) about `folder`.
template <typename Action>
void with_clear_errors(const fs::path& folder, const Action& action) {
    try {
        action();
    } catch (const fs::filesystem_error& e) {
        fail(folder, fmt::format("cannot be written ({})", e.code().message()),
             "check free space and permissions, or choose another folder with --out");
    }
}

/// The hidden folder in which a result for `target` is put together.
LockedFolder unfinished_folder(const fs::path& target) {
    try {
        return LockedFolder(target.parent_path(),
                            fmt::format(".{}.unfinished-", target.filename().string()),
                            LockedFolder::Readers::everybody);
    } catch (const Error& error) {
        fail(target, fmt::format("cannot be made ({})", error.what()),
             "or choose another folder with --out");
    }
}

/// Runs `action`; its errors name `folder` where they named the hidden one.
template <typename Action>
void named_as_asked(const fs::path& folder, const fs::path& hidden, const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        std::string text = error.what();
        const std::string name = hidden.string();
        for (std::size_t at = 0; (at = text.find(name)) != std::string::npos;)
            text.replace(at, name.size(), folder.string());
        throw Error(error.code(), text);
    }
}

void write_folder(const fs::path& folder, bool overwrite,
                  const std::function<void(const fs::path&)>& fill) {
    const fs::path target = resolved(folder);
    const bool replaces = fs::exists(target);
    if (replaces && !overwrite)
        fail(folder, "exists already", "choose another folder with --out, or add --overwrite");
    Parents parents(target);
    LockedFolder temporary = unfinished_folder(target);
    named_as_asked(folder, temporary.path(), [&] {
        fill(temporary.path());
        sync_tree_to_disk(temporary.path());
    });
    if (replaces) {
        exchange(temporary.path(), target);  // the destructor removes the old one
    } else {
        rename_to_new(temporary.path(), target);
        temporary.keep();
    }
    parents.keep();
    sync_to_disk(target.parent_path());
}

/// `mark`: the file that tells a folder of palpate from others.
void check_folder(const fs::path& folder, const char* mark, bool overwrite) {
    const fs::path target = resolved(folder);
    if (fs::exists(target)) {
        if (!overwrite)
            fail(folder, "exists already", "choose another folder with --out, or add --overwrite");
        if (!fs::exists(target / mark) && !fs::is_empty(target))
            fail(folder,
                 fmt::format("holds no result of palpate (no {}), so it is not replaced", mark),
                 "choose another folder with --out");
    }
    fs::path parent = target.parent_path();
    while (!fs::exists(parent)) parent = parent.parent_path();
    if (!fs::is_directory(parent)) fail(parent, "is not a folder", "choose another with --out");
    if (::access(parent.c_str(), W_OK | X_OK) != 0) fail_with_errno(parent, "cannot be written to");
}

}  // namespace

void check_output_folder(const fs::path& folder, const char* mark, bool overwrite) {
    with_clear_errors(folder, [&] { check_folder(folder, mark, overwrite); });
}

void write_folder_atomically(const fs::path& folder, bool overwrite,
                             const std::function<void(const fs::path&)>& fill) {
    with_clear_errors(folder, [&] { write_folder(folder, overwrite, fill); });
}

void make_folders(const fs::path& folder) {
    with_clear_errors(folder, [&] { fs::create_directories(folder); });
}

void write_text_file(const fs::path& path, const std::string& text) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0) fail_with_errno(path.filename(), "cannot be made");
    const bool written = write_all(file, text);
    const int reason = errno;
    const bool closed = ::close(file) == 0;
    if (written && closed) return;
    if (!written) errno = reason;
    fail_with_errno(path.filename(), "cannot be written");
}

}  // namespace palpate

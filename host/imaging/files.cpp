// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/imaging/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

bool make_durable(const std::filesystem::path& path) {
    const int file = open(path.c_str(), O_RDONLY);
    if (file < 0) return false;
    int status = 0;
    while ((status = fsync(file)) != 0 && errno == EINTR) {
    }
    const bool done = status == 0 || errno == EINVAL;  // EINVAL: a file system without fsync
    close(file);
    return done;
}

std::filesystem::path temporary_place() {
    std::error_code error;
    const std::filesystem::path place = std::filesystem::temp_directory_path(error);
    if (error)
        throw Error(ErrorCode::output_failed,
                    "there is no folder for temporary files; set TMPDIR to a folder with space");
    return place;
}

}  // namespace

PrivateFolder::PrivateFolder()
    : folder_(temporary_place(), "palpate-private-", LockedFolder::Readers::owner) {}

std::optional<std::string> why_unreadable(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return "there is no such file";
    if (!std::filesystem::is_regular_file(path, error)) return "it is not a file";
    if (std::filesystem::file_size(path, error) == 0) return "it is empty";
    if (!std::ifstream(path, std::ios::binary)) return "it may not be read";
    return std::nullopt;
}

void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write) {
    const std::filesystem::path parent = path.has_parent_path() ? path.parent_path() : ".";
    const std::string name = path.filename().string();
    try {
        const LockedFolder folder(parent, "." + name + ".unfinished-",
                                  LockedFolder::Readers::everybody);
        const std::filesystem::path temporary = folder.path() / name;
        write(temporary);
        if (!make_durable(temporary)) throw Error(ErrorCode::output_failed, "the disk refused it");
        std::filesystem::rename(temporary, path);
        if (!make_durable(parent)) throw Error(ErrorCode::output_failed, "the disk refused it");
    } catch (const std::exception& failure) {
        if (const auto* ours = dynamic_cast<const Error*>(&failure);
            ours &&
            (ours->code() == ErrorCode::unsupported || ours->code() == ErrorCode::cancelled)) {
            throw;
        }
        throw Error(ErrorCode::output_failed, "cannot write '" + path.string() +
                                                  "': " + failure.what() +
                                                  "; check that the folder exists and has space");
    }
}

}  // namespace palpate

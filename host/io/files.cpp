// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/files.hpp"

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

[[noreturn]] void cannot_write(const std::filesystem::path& path, const std::string& reason) {
    throw Error(ErrorCode::output_failed, "cannot write '" + path.string() + "': " + reason);
}

/// What `work` throws, as Error(output_failed) with the name of the file; errors of the caller
/// stay.
void told_with_name(const std::filesystem::path& path, const std::function<void()>& work) {
    try {
        work();
    } catch (const std::exception& failure) {
        if (const auto* ours = dynamic_cast<const Error*>(&failure);
            ours &&
            (ours->code() == ErrorCode::unsupported || ours->code() == ErrorCode::cancelled)) {
            throw;
        }
        cannot_write(path, std::string(failure.what()) + "; check free space and permissions");
    }
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

UnfinishedFile::UnfinishedFile(std::filesystem::path path)
    : path_(std::move(path)), parent_(path_.has_parent_path() ? path_.parent_path() : ".") {
    std::error_code error;
    if (!std::filesystem::is_directory(parent_, error))
        cannot_write(path_, "there is no folder '" + parent_.string() + "'; make it first");
    std::string prefix = path_.filename().string();
    prefix.insert(0, 1, '.');
    try {
        folder_.emplace(parent_, prefix.append(".unfinished-"), LockedFolder::Readers::everybody);
    } catch (const Error& failure) {  // says what to do
        cannot_write(path_, failure.what());
    }
}

void UnfinishedFile::write(
    const std::function<void(const std::filesystem::path& temporary)>& write) {
    told_with_name(path_, [&] {
        const std::filesystem::path temporary = folder_->path() / path_.filename();
        write(temporary);
        if (!make_durable(temporary)) throw Error(ErrorCode::output_failed, "the disk refused it");
    });
}

void UnfinishedFile::finish() {
    told_with_name(path_, [&] {
        std::filesystem::rename(folder_->path() / path_.filename(), path_);
        if (!make_durable(parent_)) throw Error(ErrorCode::output_failed, "the disk refused it");
    });
}

void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write) {
    UnfinishedFile file(path);
    file.write(write);
    file.finish();
}

}  // namespace palpate

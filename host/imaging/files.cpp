// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/imaging/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

bool make_durable(const std::filesystem::path& path) {
    const int file = open(path.c_str(), O_RDONLY);
    if (file < 0) return false;
    const bool done = fsync(file) == 0;
    close(file);
    return done;
}

}  // namespace

PrivateFolder::PrivateFolder() {
    std::error_code error;
    std::string name = (std::filesystem::temp_directory_path(error) / "palpate-XXXXXX").string();
    if (error || !mkdtemp(name.data())) {
        throw Error(ErrorCode::output_failed,
                    "no temporary folder could be made; set TMPDIR to a folder with space");
    }
    path_ = name;
}

PrivateFolder::~PrivateFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::optional<std::string> why_unreadable(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return "there is no such file";
    if (!std::filesystem::is_regular_file(path, error)) return "it is not a file";
    if (std::filesystem::file_size(path, error) == 0) return "it is empty";
    if (!std::ifstream(path, std::ios::binary)) return "it may not be read";
    return std::nullopt;
}

std::string unfinished_prefix() {
    char host[65] = "";
    if (gethostname(host, sizeof host - 1) != 0) host[0] = 0;
    return ".unfinished-" + std::string(host) + "-" + std::to_string(getpid()) + "-";
}

void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write) {
    static std::atomic<int> counter{0};
    const std::string prefix = unfinished_prefix() + std::to_string(counter++) + "-";
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    const std::filesystem::path temporary = folder / (prefix + path.filename().string());
    std::error_code error;
    try {
        write(temporary);
        if (!make_durable(temporary)) throw Error(ErrorCode::output_failed, "the disk refused it");
        std::filesystem::rename(temporary, path);
        make_durable(folder);
    } catch (const std::exception& failure) {
        std::filesystem::remove(temporary, error);
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

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace palpate {

/// Why a label volume cannot be used, as far as its header tells, in words; empty: it can.
std::optional<std::string> header_fault(const std::filesystem::path& path);

/// Hashes of files, kept between plans: a file of the same size, time of change and inode is not
/// read again.
class HashCache {
public:
    explicit HashCache(std::filesystem::path file);
    /// Throws what `sha256_of_file` throws.
    const std::string& hash_of(const std::filesystem::path& path);
    /// Throws Error(output_failed).
    void write() const;

private:
    struct Entry {
        std::string mark;  ///< size, time of change, inode
        std::string sha256;
        bool is_used = false;
    };
    std::filesystem::path file_;
    std::map<std::string, Entry> entries_;
};

}  // namespace palpate

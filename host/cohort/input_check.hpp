// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace palpate {

/// Why a label volume cannot be used, as far as its header tells, in words; empty: it can.
std::optional<std::string> header_fault(const std::filesystem::path& path);

/// What is known of a file: that it can be used, and its hash; or why not.
struct FileFacts {
    std::string sha256;  ///< empty: it cannot be used
    std::string fault;   ///< in words
};

/// Looks at each file once, and remembers between plans: a file of the same size, time of change
/// and inode that was found good is not opened again.
class FileChecks {
public:
    /// `with_voxels`: a label volume is inflated, not only its header.
    FileChecks(std::filesystem::path file, bool with_voxels);
    /// Of a label volume.
    FileFacts volume(const std::string& path);
    /// Of any other file.
    FileFacts plain_file(const std::string& path);
    /// Labels of volumes that were inflated for this plan: which of `wanted` a volume lacks. Empty
    /// if it was not inflated, or has all.
    std::vector<int> missing_labels(const std::string& path, const std::vector<int>& wanted) const;
    /// Writes what is known of the files that were asked for. Throws Error(output_failed).
    void write() const;

private:
    /// Size, time of change, inode.
    using Mark = std::array<std::uint64_t, 4>;
    struct Entry {
        Mark mark{};
        std::array<unsigned char, 32> sha256{};
        bool is_good = false, has_voxels = false, is_asked = false, is_seen = false;
    };
    static Mark mark_of(const std::string& path);
    FileFacts look(const std::string& path, bool is_volume);
    std::string fault_of(const std::string& path, bool is_volume);

    std::filesystem::path file_;
    bool with_voxels_;
    std::unordered_map<std::string, Entry> entries_;
    std::map<std::string, std::string> faults_;
    std::map<std::string, std::vector<int>> labels_;
};

}  // namespace palpate

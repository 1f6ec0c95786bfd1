// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/input_check.hpp"

#include <fmt/core.h>
#include <sys/stat.h>

#include <array>
#include <cstring>
#include <fstream>
#include <vector>

#include "host/cohort/cohort_plan.hpp"
#include "host/cohort/content_key.hpp"
#include "host/io/delimited_text.hpp"
#include "host/io/files.hpp"
#include "host/io/gzip.hpp"
#include "host/io/preflight.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t nifti_header_bytes = 348, start_bytes = 8192;

std::vector<std::uint8_t> start_of(const fs::path& path) {
    std::vector<std::uint8_t> bytes(start_bytes);
    std::ifstream in(path, std::ios::binary);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    return bytes;
}

std::optional<std::string> nifti_fault(const fs::path& path) {
    std::vector<std::uint8_t> bytes = start_of(path);
    if (is_gzip(bytes)) {
        try {
            bytes = inflated_start(bytes, nifti_header_bytes);
        } catch (const Error&) {
            return "it is damaged: its header cannot be inflated";
        }
    }
    if (bytes.size() < nifti_header_bytes) return "it is cut off before the end of its header";
    const bool is_nifti = std::memcmp(bytes.data() + 344, "n+1", 4) == 0;
    return is_nifti ? std::nullopt
                    : std::optional<std::string>("it is named NIfTI, but holds no NIfTI-1 header");
}

std::string mark_of(const fs::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return "";
    return fmt::format("{}:{}.{:09}:{}", status.st_size, status.st_mtim.tv_sec,
                       status.st_mtim.tv_nsec, status.st_ino);
}

}  // namespace

std::optional<std::string> header_fault(const fs::path& path) {
    if (const auto why = why_unreadable(path)) return *why;
    const auto format = format_of(path);
    if (!format) return "its name ends in none of .nii .nii.gz .nrrd .mha";
    if (has_ending(path, ".nhdr") || has_ending(path, ".mhd"))
        return "its voxels lie in another file; a cohort takes volumes of one file";
    if (*format == VolumeFormat::nifti) return nifti_fault(path);
    const std::vector<std::uint8_t> bytes = start_of(path);
    const std::string text(bytes.begin(), bytes.end());
    if (*format == VolumeFormat::nrrd && !text.starts_with("NRRD"))
        return "it is named NRRD, but does not begin as one";
    if (*format == VolumeFormat::meta && text.find("NDims") == std::string::npos)
        return "it is named MetaImage, but holds no NDims";
    return std::nullopt;
}

HashCache::HashCache(fs::path file) : file_(std::move(file)) {
    if (!fs::exists(file_)) return;
    const DelimitedText table = parse_delimited(text_of_file(file_), {'\t'});
    if (table.columns.size() != 3) return;
    for (const auto& row : table.rows) entries_[row[0]] = {row[1], row[2], false};
}

const std::string& HashCache::hash_of(const fs::path& path) {
    Entry& entry = entries_[path.string()];
    entry.is_used = true;
    const std::string mark = mark_of(path);
    if (entry.sha256.empty() || entry.mark != mark) entry = {mark, sha256_of_file(path), true};
    return entry.sha256;
}

void HashCache::write() const {
    std::string text = delimited_line({"file", "mark", "sha256"}, '\t');
    for (const auto& [path, entry] : entries_)
        if (entry.is_used) text += delimited_line({path, entry.mark, entry.sha256}, '\t');
    replace_text(file_, text);
}

}  // namespace palpate

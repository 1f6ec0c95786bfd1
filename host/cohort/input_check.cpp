// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/input_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>

#include "host/cohort/cohort_plan.hpp"
#include "host/cohort/content_key.hpp"
#include "host/io/delimited_text.hpp"
#include "host/io/files.hpp"
#include "host/io/gzip.hpp"
#include "host/io/preflight.hpp"
#include "host/io/volume_files.hpp"
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

constexpr const char* known_header[] = {"file", "mark", "sha256", "checked"};
constexpr const char *header_word = "header", *voxels_word = "voxels";

std::array<unsigned char, 32> bytes_of_hex(const std::string& text) {
    std::array<unsigned char, 32> bytes{};
    for (std::size_t k = 0; k < bytes.size() && 2 * k + 1 < text.size(); ++k)
        std::from_chars(text.data() + 2 * k, text.data() + 2 * k + 2, bytes[k], 16);
    return bytes;
}

std::string hex_of_bytes(const std::array<unsigned char, 32>& bytes) {
    std::string text;
    for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
    return text;
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

FileChecks::FileChecks(fs::path file, bool with_voxels)
    : file_(std::move(file)), with_voxels_(with_voxels) {
    if (!fs::exists(file_)) return;
    const std::string text = text_of_file(file_);
    for_each_row(text, {'\t', false, true}, [&](RawRow& row) {
        if (row.cells.size() != std::size(known_header)) return;
        Entry entry;
        const char* at = row.cells[1].data();
        const char* end = at + row.cells[1].size();
        for (std::uint64_t& number : entry.mark) {
            at = std::from_chars(at, end, number).ptr;
            at += at < end;
        }
        entry.sha256 = bytes_of_hex(row.cells[2]);
        entry.is_good = row.cells[2].size() == 64;
        entry.has_voxels = row.cells[3] == voxels_word;
        entries_.emplace(std::move(row.cells[0]), entry);
    });
}

FileChecks::Mark FileChecks::mark_of(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return {};
    return {std::uint64_t(status.st_size), std::uint64_t(status.st_mtim.tv_sec),
            std::uint64_t(status.st_mtim.tv_nsec), status.st_ino};
}

std::string FileChecks::fault_of(const std::string& path, bool is_volume) {
    if (!is_volume) return why_unreadable(path).value_or("");
    if (const auto fault = header_fault(path)) return *fault;
    if (!with_voxels_) return "";
    try {
        const LabelImage image = read_label_image(path);
        std::set<int> labels(image.voxels.begin(), image.voxels.end());
        labels_[path] = {labels.begin(), labels.end()};
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

FileFacts FileChecks::look(const std::string& path, bool is_volume) {
    Entry& entry = entries_[path];
    entry.is_asked = true;
    if (!entry.is_seen) {
        entry.is_seen = true;
        const Mark mark = mark_of(path);
        const bool wants_voxels = is_volume && with_voxels_;  // their labels are not remembered
        const bool is_known = entry.is_good && entry.mark == mark && mark != Mark{};
        if (!is_known || wants_voxels) {
            entry.mark = mark;
            const std::string fault = fault_of(path, is_volume);
            entry.is_good = fault.empty();
            entry.has_voxels = wants_voxels;
            if (!fault.empty()) faults_[path] = fault;
            if (entry.is_good && !is_known) entry.sha256 = bytes_of_hex(sha256_of_file(path));
        }
    }
    if (entry.is_good) return {hex_of_bytes(entry.sha256), ""};
    return {"", faults_.at(path)};
}

FileFacts FileChecks::volume(const std::string& path) { return look(path, true); }
FileFacts FileChecks::plain_file(const std::string& path) { return look(path, false); }

std::vector<int> FileChecks::missing_labels(const std::string& path,
                                            const std::vector<int>& wanted) const {
    const auto found = labels_.find(path);
    std::vector<int> missing;
    if (found == labels_.end()) return missing;
    for (const int label : wanted)
        if (!std::binary_search(found->second.begin(), found->second.end(), label))
            missing.push_back(label);
    return missing;
}

void FileChecks::write() const {
    write_atomically(file_, [&](const fs::path& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        out.exceptions(std::ios::badbit | std::ios::failbit);
        out << delimited_line({std::begin(known_header), std::end(known_header)}, '\t');
        for (const auto& [path, entry] : entries_)
            if (entry.is_asked && entry.is_good)
                out << delimited_line(
                    {path, fmt::format("{}", fmt::join(entry.mark, ":")),
                     hex_of_bytes(entry.sha256), entry.has_voxels ? voxels_word : header_word},
                    '\t');
        out.close();
    });
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/preflight.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>

#include "host/io/gzip.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::uintmax_t max_file_bytes = std::uintmax_t(1) << 33;

CheckedVolume checked(const std::filesystem::path& path, Voxels voxels) {
    const auto format = format_of(path);
    if (!format) {
        detail::unreadable("its format is unknown; use .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd");
    }
    std::vector<std::uint8_t> bytes = detail::load(path);
    switch (*format) {
        case VolumeFormat::nifti:
            return detail::preflight_nifti(std::move(bytes), voxels);
        case VolumeFormat::nrrd:
            return detail::preflight_nrrd(std::move(bytes), path.parent_path(),
                                          has_ending(path, ".nhdr"));
        case VolumeFormat::meta:
            return detail::preflight_meta(std::move(bytes), path.parent_path(),
                                          has_ending(path, ".mhd"));
    }
    detail::unreadable("its format is unknown");
}

}  // namespace

bool has_ending(const std::filesystem::path& path, const std::string& ending) {
    std::string name = path.filename().string();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name.size() > ending.size() && name.ends_with(ending);
}

std::optional<VolumeFormat> format_of(const std::filesystem::path& path) {
    if (has_ending(path, ".nii") || has_ending(path, ".nii.gz")) return VolumeFormat::nifti;
    if (has_ending(path, ".nrrd") || has_ending(path, ".nhdr")) return VolumeFormat::nrrd;
    if (has_ending(path, ".mha") || has_ending(path, ".mhd")) return VolumeFormat::meta;
    return std::nullopt;
}

CheckedVolume preflight(const std::filesystem::path& path, Voxels voxels) {
    try {
        return checked(path, voxels);
    } catch (const Error& error) {
        throw Error(error.code(), "cannot use '" + path.string() + "': " + error.what());
    }
}

CheckedVolume preflight_vectors(const std::filesystem::path& path) {
    try {
        if (format_of(path) != VolumeFormat::nifti) {
            detail::unreadable("a displacement field is .nii or .nii.gz");
        }
        return detail::preflight_nifti_vectors(detail::load(path));
    } catch (const Error& error) {
        throw Error(error.code(), "cannot use '" + path.string() + "': " + error.what());
    }
}

namespace detail {

void unreadable(const std::string& reason) { throw Error(ErrorCode::input_unreadable, reason); }
void unusable(const std::string& reason) { throw Error(ErrorCode::input_unusable, reason); }
void not_finite(std::size_t position) {
    unusable("its number " + std::to_string(position) +
             " is not a finite number, or too large for single precision; replace such voxels");
}

std::vector<std::uint8_t> load(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) unreadable("there is no such file");
    if (!std::filesystem::is_regular_file(status)) unreadable("it is not a file");
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) unreadable("its size cannot be read");
    if (size == 0) unreadable("it is empty");
    if (size > max_file_bytes) unreadable("it is larger than 8 GiB");
    std::vector<std::uint8_t> bytes(size);
    std::ifstream in(path, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
        unreadable("it could not be read to its end; check the permissions");
    }
    return bytes;
}

std::vector<std::uint8_t> load_detached(const std::filesystem::path& folder,
                                        const std::string& name) {
    const std::filesystem::path relative(name);
    const bool leaves = relative.is_absolute() ||
                        std::find(relative.begin(), relative.end(), "..") != relative.end();
    std::error_code error;
    const std::filesystem::path here = folder.empty() ? "." : folder;
    const auto root = std::filesystem::canonical(here, error);
    const auto file = std::filesystem::weakly_canonical(here / relative, error);
    const auto [end_of_root, unused] =
        std::mismatch(root.begin(), root.end(), file.begin(), file.end());
    (void)unused;
    if (leaves || end_of_root != root.end()) {
        unreadable("its header points to data outside its folder; put both files side by side");
    }
    try {
        return load(file);
    } catch (const Error& failure) {
        unreadable(std::string("of the data file that its header names: ") + failure.what());
    }
}

std::size_t checked_num_voxels(const std::vector<long long>& sizes) {
    if (sizes.size() != 3) {
        unusable("it has " + std::to_string(sizes.size()) +
                 " dimensions; a volume of three is needed, one number per voxel");
    }
    std::size_t product = 1;
    for (long long size : sizes) {
        if (size < 1) unreadable("its header gives an extent of " + std::to_string(size));
        if (size < 2) unusable("it is a single slice; a volume is needed");
        if (std::size_t(size) > max_voxels / product) unusable("it has more than 2^30 voxels");
        product *= std::size_t(size);
    }
    return product;
}

std::string trimmed(const std::string& text) {
    const char* blank = " \t\r\n";
    const auto first = text.find_first_not_of(blank);
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<long long> whole_numbers(const std::string& text) {
    std::istringstream in(text);
    std::vector<long long> numbers;
    for (long long number; in >> number;) numbers.push_back(number);
    if (!in.eof() || numbers.size() > 16)
        unreadable("its header has a bad number: " + text.substr(0, 60));
    return numbers;
}

std::vector<double> finite_numbers(const std::string& text) {
    std::istringstream in(text);
    std::vector<double> numbers;
    for (std::string word; in >> word;) {
        char* end = nullptr;
        const double number = std::strtod(word.c_str(), &end);
        if (*end != 0 || !std::isfinite(number) || numbers.size() >= 16) {
            unreadable("its header has a bad number: " + text.substr(0, 60));
        }
        numbers.push_back(number);
    }
    return numbers;
}

std::vector<std::uint8_t> checked_data(std::span<const std::uint8_t> bytes, bool compressed,
                                       std::size_t needed) {
    std::vector<std::uint8_t> content;
    if (compressed) {
        content = inflated(bytes, needed + max_trailing_bytes);
        bytes = content;
    }
    const std::size_t there = bytes.size();
    if (there < needed) {
        unreadable("it holds " + std::to_string(there) + " bytes of voxels, its header announces " +
                   std::to_string(needed) + "; it was cut off");
    }
    if (there > needed + max_trailing_bytes) {
        unreadable("it holds more data than its header announces");
    }
    if (compressed) {
        content.resize(needed);
        return content;
    }
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(needed)};
}

CheckedVolume::File joined(const char* name, const std::string& header,
                           const std::vector<std::uint8_t>& voxels) {
    CheckedVolume::File file{name, {}};
    file.bytes.reserve(header.size() + voxels.size());
    file.bytes.assign(header.begin(), header.end());
    file.bytes.insert(file.bytes.end(), voxels.begin(), voxels.end());
    return file;
}

}  // namespace detail
}  // namespace palpate

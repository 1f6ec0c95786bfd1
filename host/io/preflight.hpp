// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/io/image.hpp"

namespace palpate {

enum class VolumeFormat { nifti, nrrd, meta };

/// A volume file that was checked byte by byte, ready for the decoder. The decoder gets this copy,
/// uncompressed and with nothing in its header but what is needed, and not the original files: ITK
/// would accept damaged ones, take zeros for compressed data without a stated size and, beside
/// A.nii, read that instead of A.nii.gz. Nobody's name in a header goes further than here.
struct CheckedVolume {
    struct File {
        std::filesystem::path name;  ///< its ending tells the decoder the format
        std::vector<std::uint8_t> bytes;
    };
    VolumeFormat format = VolumeFormat::nifti;
    std::array<Index, 3> size{0, 0, 0};
    unsigned components = 1;        ///< numbers per voxel
    std::optional<ImageGrid> grid;  ///< if given, it holds and not the decoder's (NIfTI)
    File file;
    std::vector<std::string> warnings;  ///< sentences about what is odd but was accepted
};

/// Whether the name ends so, in any case; `ending` with its dot and in lower case.
bool has_ending(const std::filesystem::path& path, const std::string& ending);

/// Format by the ending of the name (.nii .nii.gz .nrrd .nhdr .mha .mhd, any case), if known.
std::optional<VolumeFormat> format_of(const std::filesystem::path& path);

/// What the numbers of a volume are for. Those that are used must be finite; the NIfTI decoder
/// would silently take 0 for others, so that is told here.
enum class Voxels { used, unused };

/// Loads and checks a 3D scalar volume.
/// Throws Error(input_unreadable) for a damaged file, Error(input_unusable) for a sound one that is
/// not a 3D scalar volume in mm; messages start with the file.
CheckedVolume preflight(const std::filesystem::path& path, Voxels voxels = Voxels::used);

/// The same for a displacement field: NIfTI of five dimensions (x, y, z, 1, 3) with intent 1007,
/// LPS mm. Other intents and shapes are refused: who wrote them decides what their axes mean.
CheckedVolume preflight_vectors(const std::filesystem::path& path);

/// The smallest volume that is accepted has two voxels along each axis.
constexpr std::size_t max_voxels = std::size_t(1) << 30;
/// Bytes tolerated behind the voxels.
constexpr std::size_t max_trailing_bytes = std::size_t(1) << 20;

namespace detail {
/// The parts of `preflight`, in their own files; messages without the file's name.
CheckedVolume preflight_nifti(std::vector<std::uint8_t> bytes, Voxels voxels);
CheckedVolume preflight_nifti_vectors(std::vector<std::uint8_t> bytes);
CheckedVolume preflight_nrrd(std::vector<std::uint8_t> bytes, const std::filesystem::path& folder,
                             bool detached);
CheckedVolume preflight_meta(std::vector<std::uint8_t> bytes, const std::filesystem::path& folder,
                             bool detached);

std::vector<std::uint8_t> load(const std::filesystem::path& path);
/// The content of a data file that a header names, which must lie in the header's folder.
std::vector<std::uint8_t> load_detached(const std::filesystem::path& folder,
                                        const std::string& name);
[[noreturn]] void unreadable(const std::string& reason);
[[noreturn]] void unusable(const std::string& reason);
/// Of the number at this position.
[[noreturn]] void not_finite(std::size_t position);
/// Checks the extents and returns their product.
std::size_t checked_num_voxels(const std::vector<long long>& sizes);
/// Whole numbers or finite numbers separated by blanks; throws for anything else.
std::vector<long long> whole_numbers(const std::string& text);
std::vector<double> finite_numbers(const std::string& text);
std::string trimmed(const std::string& text);
/// The `needed` bytes of voxels that `bytes` hold, inflated first if `compressed`. Throws unless
/// there are that many and little more.
std::vector<std::uint8_t> checked_data(std::span<const std::uint8_t> bytes, bool compressed,
                                       std::size_t needed);
/// A file of a header and the voxels behind it.
CheckedVolume::File joined(const char* name, const std::string& header,
                           const std::vector<std::uint8_t>& voxels);
}  // namespace detail

}  // namespace palpate

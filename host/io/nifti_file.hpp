// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "host/io/image.hpp"

namespace palpate {

enum class NiftiNumbers {
    bytes,          ///< std::uint8_t
    words,          ///< std::uint16_t
    singles,        ///< float
    displacements,  ///< three volumes of float, x, y and z, with intent 1007
};

/// A NIfTI-1 file in memory: its header, and room for the numbers, i fastest.
/// ITK writes the same more slowly, and does not notice a full disk.
class NiftiFile {
public:
    /// Throws Error(output_failed) if the format cannot count that many voxels along an axis.
    NiftiFile(const ImageGrid& grid, NiftiNumbers numbers);

    /// To be filled, uninitialised at first.
    template <typename T>
    T* numbers() {
        return reinterpret_cast<T*>(bytes_.get() + numbers_offset);
    }
    /// As .nii or .nii.gz, all or nothing. Throws Error(output_failed).
    void write(const std::filesystem::path& path) const;

private:
    static constexpr std::size_t numbers_offset = 352;

    std::size_t size_;
    std::unique_ptr<std::uint8_t[]> bytes_;
};

}  // namespace palpate

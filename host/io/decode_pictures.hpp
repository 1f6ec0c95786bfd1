// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "solver/base/log.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// Of a picture of a camera.
struct GreyShape {
    Index width = 0, height = 0;
    Index largest = 0;  ///< grey of white: 255 or 65535

    bool operator==(const GreyShape&) const = default;
    std::size_t num_pixels() const { return std::size_t(width) * std::size_t(height); }
};

constexpr Index most_pixels_a_side = 16384;

/// What a PNG or TIFF file holds. All of this file is done by ITK in a child process with limits of
/// memory and time, and throws Error(input_unreadable) naming the file and what is wrong: damaged
/// or cut, several pages, more than `most_pixels_a_side`, other numbers than of 8 or 16 bits.
GreyShape shape_of_picture(const std::filesystem::path& file, const ProgressSink& progress = {});

/// The grey values of PNG and TIFF files of one shape, in one child: [files, height, width], rows
/// from the top. Of colours the luma 0.299 R + 0.587 G + 0.114 B; transparency is left out.
std::vector<std::uint16_t> decode_pictures(std::span<const std::filesystem::path> files,
                                           const GreyShape& shape,
                                           const ProgressSink& progress = {});

}  // namespace palpate

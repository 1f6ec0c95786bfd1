// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"

namespace palpate {

/// Frames one after the other, in constant memory.
class FrameSource {
public:
    /// The PGM files of a folder in the order of their names, which must be of one size and depth.
    /// Throws Error(input_unreadable) if there is none.
    explicit FrameSource(const std::filesystem::path& folder);
    /// Raw grey bytes, frame after frame.
    ///   size   "180x180": width and height
    /// Throws Error(invalid_argument) for another text.
    FrameSource(std::istream& bytes, const std::string& size);

    /// The next frame; false after the last. Throws Error(input_unreadable) for one that is
    /// damaged, cut or of another size, Error(input_unusable) for one that is all black or white.
    bool next(GreyFrame& frame);
    /// How many there are; 0 if nobody knows.
    Index num_frames() const { return Index(files_.size()); }

private:
    void read_file(const std::filesystem::path& file, GreyFrame& frame);

    std::vector<std::filesystem::path> files_;
    std::istream* bytes_ = nullptr;
    Index width_ = 0, height_ = 0, depth_ = 0, number_ = 0;
    std::vector<char> buffer_;
};

/// A grey picture in the format PGM (P5, 8 or 16 bits), white as 255; its largest value into
/// `depth`. Throws Error(input_unreadable), without the file's name.
GreyFrame parse_pgm(const std::vector<char>& bytes, Index& depth);

}  // namespace palpate

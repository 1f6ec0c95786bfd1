// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <istream>
#include <memory>
#include <optional>
#include <string>

#include "host/apps/aspirate/contours/outline.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Frames from one kind of place.
class FrameReader {
public:
    virtual ~FrameReader() = default;
    /// The next frame; false after the last. Throws Error(input_unreadable) for one that is
    /// damaged, cut, or of another size or depth than those before.
    virtual bool next(GreyFrame& frame) = 0;
    /// How many there are; 0 if nobody knows.
    virtual Index num_frames() const { return 0; }
    /// When the last frame was taken, if the film says so.
    virtual std::optional<double> time_s() const { return std::nullopt; }
};

/// Raw grey bytes, frame after frame; `size` is "180x180", width and height.
/// Throws Error(invalid_argument) for another text.
std::unique_ptr<FrameReader> read_raw_frames(std::istream& bytes, const std::string& size);

/// The .pgm, .png or .tif (.tiff) files of a folder in the order of their names. PNG and TIFF are
/// decoded in a child process, some at a time. Throws Error(input_unreadable) if there is none, or
/// files of two kinds.
std::unique_ptr<FrameReader> read_picture_folder(const std::filesystem::path& folder,
                                                 const ProgressSink& progress);

/// Whether the name of a file is one of a film (.avi, .mp4, ...).
bool is_film_name(const std::filesystem::path& file);

/// A film, by the program `ffmpeg` of PATH, in 8 bits of grey, with the times that the film says.
/// Throws Error(invalid_argument) if there is no such program, Error(input_unreadable) if the file
/// cannot be read.
std::unique_ptr<FrameReader> read_film(const std::filesystem::path& file,
                                       const ProgressSink& progress);

}  // namespace palpate

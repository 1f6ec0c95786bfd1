// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/aspirate/frames/frame_reader.hpp"

namespace palpate {

/// Frames one after the other, in constant memory, wherever they come from.
class FrameSource {
public:
    /// A folder of pictures (`read_picture_folder`), or a film (`read_film`).
    explicit FrameSource(const std::filesystem::path& path, const ProgressSink& progress = {});
    /// Raw grey bytes (`read_raw_frames`).
    FrameSource(std::istream& bytes, const std::string& size);

    /// The next frame; false after the last. Throws what its reader throws, and
    /// Error(input_unusable) for one that is all black or white.
    bool next(GreyFrame& frame);
    /// How many there are; 0 if nobody knows.
    Index num_frames() const { return reader_->num_frames(); }
    /// When the last frame was taken, if the film says so.
    std::optional<double> time_s() const { return reader_->time_s(); }

private:
    std::unique_ptr<FrameReader> reader_;
    Index number_ = 0;
};

}  // namespace palpate

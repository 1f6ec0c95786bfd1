// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/frames/frame_source.hpp"

#include <fmt/format.h>

#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double same_part = 0.98;  // of the pixels are black or white: nothing to be seen

void refuse_black_or_white(const GreyFrame& frame, const std::string& name) {
    std::size_t black = 0, white = 0;
    for (const float grey : frame.grey) {
        black += grey <= 0;
        white += grey >= 255;
    }
    const double all = double(frame.grey.size());
    for (const auto& [count, what] : {std::pair{black, "black"}, {white, "white"}})
        if (double(count) > same_part * all)
            throw Error(
                ErrorCode::input_unusable,
                fmt::format("{} is all {}; correct the exposure or leave it out", name, what));
}

}  // namespace

FrameSource::FrameSource(const std::filesystem::path& path, const ProgressSink& progress)
    : reader_(is_film_name(path) ? read_film(path, progress)
                                 : read_picture_folder(path, progress)) {}

FrameSource::FrameSource(std::istream& bytes, const std::string& size)
    : reader_(read_raw_frames(bytes, size)) {}

bool FrameSource::next(GreyFrame& frame) {
    if (!reader_->next(frame)) return false;
    ++number_;
    refuse_black_or_white(frame, fmt::format("frame {}", number_));
    return true;
}

}  // namespace palpate

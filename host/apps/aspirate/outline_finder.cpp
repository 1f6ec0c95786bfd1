// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/outline_finder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate {

void OutlineFinder::begin(Index width, Index height) {
    width_ = width;
    height_ = height;
    if (instrument_.crop_px) {
        const auto [left, top, wide, high] = *instrument_.crop_px;
        if (left + wide > width || top + high > height)
            throw Error(ErrorCode::input_unusable,
                        fmt::format("crop_px reaches to column {} and row {}, but frames have {} x "
                                    "{} pixels; correct it",
                                    left + wide, top + high, width, height));
        part_ = {wide, high, std::vector<float>(std::size_t(wide * high))};
        width = wide;
        height = high;
    }
    const ContourSettings settings = instrument_.contours(width, height);
    if (instrument_.is_published)
        published_.emplace(settings);
    else
        ours_.emplace(settings);
}

const Outline& OutlineFinder::add(const GreyFrame& frame) {
    if (!ours_ && !published_) begin(frame.width, frame.height);
    if (frame.width != width_ || frame.height != height_)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("a frame has {} x {} pixels, those before have {} x {}; give "
                                "frames of one size",
                                frame.width, frame.height, width_, height_));
    seen_ = &frame;
    if (instrument_.crop_px) {
        const auto [left, top, wide, high] = *instrument_.crop_px;
        for (Index y = 0; y < high; ++y)
            std::copy_n(frame.grey.begin() + (top + y) * width_ + left, wide,
                        part_.grey.begin() + y * wide);
        seen_ = &part_;
    }
    return ours_ ? ours_->add(*seen_) : published_->add(*seen_);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <vector>

#include "host/apps/aspirate/frames/frame_reader.hpp"
#include "host/io/decode_pictures.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

class RawFrames final : public FrameReader {
public:
    RawFrames(std::istream& bytes, const std::string& size) : bytes_(bytes) {
        int used = 0;
        if (std::sscanf(size.c_str(), "%dx%d%n", &width_, &height_, &used) != 2 ||
            std::size_t(used) != size.size() || width_ < 1 || height_ < 1 ||
            width_ > most_pixels_a_side || height_ > most_pixels_a_side)
            throw Error(
                ErrorCode::invalid_argument,
                fmt::format("raw is '{}'; allowed: WIDTHxHEIGHT in pixels, such as 180x180", size));
        buffer_.resize(std::size_t(width_) * std::size_t(height_));
    }

    bool next(GreyFrame& frame) override {
        bytes_.read(buffer_.data(), std::streamsize(buffer_.size()));
        const auto got = std::size_t(bytes_.gcount());
        if (got == 0) return false;
        ++number_;
        if (got < buffer_.size())
            throw Error(ErrorCode::input_unreadable,
                        fmt::format("frame {} is cut: {} of {} bytes; check --raw", number_, got,
                                    buffer_.size()));
        frame.width = width_;
        frame.height = height_;
        frame.grey.resize(buffer_.size());
        for (std::size_t n = 0; n < buffer_.size(); ++n)
            frame.grey[n] = float(static_cast<unsigned char>(buffer_[n]));
        return true;
    }

private:
    std::istream& bytes_;
    Index width_ = 0, height_ = 0, number_ = 0;
    std::vector<char> buffer_;
};

}  // namespace

std::unique_ptr<FrameReader> read_raw_frames(std::istream& bytes, const std::string& size) {
    return std::make_unique<RawFrames>(bytes, size);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/frame_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr Index most_pixels_a_side = 16384;
constexpr double same_part = 0.98;  // of the pixels are black or white: nothing to be seen

[[noreturn]] void unreadable(const std::string& why) {
    throw Error(ErrorCode::input_unreadable, why);
}

/// A whole number of the header behind blanks and comments.
Index header_number(const std::vector<char>& bytes, std::size_t& at) {
    while (at < bytes.size() &&
           (std::isspace(static_cast<unsigned char>(bytes[at])) || bytes[at] == '#')) {
        if (bytes[at] == '#')
            while (at < bytes.size() && bytes[at] != '\n') ++at;
        else
            ++at;
    }
    Index number = 0;
    const std::size_t begin = at;
    for (; at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[at])); ++at) {
        number = 10 * number + (bytes[at] - '0');
        if (number > 100000) unreadable("its header has a number that is too large");
    }
    if (at == begin) unreadable("its header is cut or damaged");
    return number;
}

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

GreyFrame parse_pgm(const std::vector<char>& bytes, Index& depth) {
    if (bytes.size() < 2 || bytes[0] != 'P' || bytes[1] != '5')
        unreadable("it does not begin with P5; give binary PGM files");
    std::size_t at = 2;
    GreyFrame frame;
    frame.width = header_number(bytes, at);
    frame.height = header_number(bytes, at);
    depth = header_number(bytes, at);
    if (frame.width < 1 || frame.height < 1 || frame.width > most_pixels_a_side ||
        frame.height > most_pixels_a_side)
        unreadable(fmt::format("it has {} x {} pixels; allowed: 1 to {} a side", frame.width,
                               frame.height, most_pixels_a_side));
    if (depth < 1 || depth > 65535)
        unreadable(fmt::format("its largest value is {}; allowed: 1 to 65535", depth));
    ++at;  // the one blank behind the header
    const std::size_t num_pixels = std::size_t(frame.width) * std::size_t(frame.height);
    const std::size_t size = depth > 255 ? 2 : 1;
    if (bytes.size() < at + size * num_pixels)
        unreadable(fmt::format("it is cut: {} of {} bytes of pixels",
                               bytes.size() - std::min(bytes.size(), at), size * num_pixels));
    frame.grey.resize(num_pixels);
    const auto* pixel = reinterpret_cast<const unsigned char*>(bytes.data() + at);
    const float white = 255.0F / float(depth);
    for (std::size_t n = 0; n < num_pixels; ++n)
        frame.grey[n] = depth == 255 ? float(pixel[n])
                        : size == 1  ? white * float(pixel[n])
                                     : white * float(256 * pixel[2 * n] + pixel[2 * n + 1]);
    return frame;
}

FrameSource::FrameSource(const std::filesystem::path& folder) {
    std::error_code failed;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
        std::string ending = entry.path().extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(),
                       [](unsigned char c) { return char(std::tolower(c)); });
        if (ending == ".pgm") files_.push_back(entry.path());
    }
    if (failed || files_.empty())
        unreadable(
            fmt::format("'{}' is no folder with frames; give a folder of .pgm files, or - and "
                        "--raw for bytes on standard input",
                        folder.string()));
    std::sort(files_.begin(), files_.end());
}

FrameSource::FrameSource(std::istream& bytes, const std::string& size) : bytes_(&bytes) {
    int used = 0;
    if (std::sscanf(size.c_str(), "%dx%d%n", &width_, &height_, &used) != 2 ||
        std::size_t(used) != size.size() || width_ < 1 || height_ < 1 ||
        width_ > most_pixels_a_side || height_ > most_pixels_a_side)
        throw Error(
            ErrorCode::invalid_argument,
            fmt::format("raw is '{}'; allowed: WIDTHxHEIGHT in pixels, such as 180x180", size));
    buffer_.resize(std::size_t(width_) * std::size_t(height_));
}

void FrameSource::read_file(const std::filesystem::path& file, GreyFrame& frame) {
    const std::string name = "the frame '" + file.string() + "'";
    if (const auto why = why_unreadable(file))
        unreadable(fmt::format("cannot read {}: {}", name, *why));
    std::ifstream in(file, std::ios::binary);
    buffer_.assign(std::istreambuf_iterator<char>(in), {});
    Index depth = 0;
    try {
        frame = parse_pgm(buffer_, depth);
    } catch (const Error& error) {
        unreadable(fmt::format("cannot read {}: {}", name, error.what()));
    }
    if (number_ == 0) {
        width_ = frame.width;
        height_ = frame.height;
        depth_ = depth;
    }
    if (frame.width != width_ || frame.height != height_ || depth != depth_)
        unreadable(
            fmt::format("{} has {} x {} pixels up to {}, those before {} x {} up to {}; give "
                        "frames of one film",
                        name, frame.width, frame.height, depth, width_, height_, depth_));
}

bool FrameSource::next(GreyFrame& frame) {
    std::string name = fmt::format("frame {}", number_ + 1);
    if (bytes_) {
        bytes_->read(buffer_.data(), std::streamsize(buffer_.size()));
        const auto got = std::size_t(bytes_->gcount());
        if (got == 0) return false;
        if (got < buffer_.size())
            unreadable(
                fmt::format("{} is cut: {} of {} bytes; check --raw", name, got, buffer_.size()));
        frame.width = width_;
        frame.height = height_;
        frame.grey.resize(buffer_.size());
        for (std::size_t n = 0; n < buffer_.size(); ++n)
            frame.grey[n] = float(static_cast<unsigned char>(buffer_[n]));
    } else {
        if (number_ == Index(files_.size())) return false;
        read_file(files_[std::size_t(number_)], frame);
    }
    refuse_black_or_white(frame, name);
    ++number_;
    return true;
}

}  // namespace palpate

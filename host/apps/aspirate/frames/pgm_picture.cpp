// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/frames/pgm_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "host/io/decode_pictures.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

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

}  // namespace palpate

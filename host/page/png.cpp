// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/png.hpp"

#include <png.h>

#include <string>

#include "solver/base/error.hpp"

namespace palpate {

std::vector<std::uint8_t> png_of(Index width, Index height, std::span<const std::uint8_t> pixels) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_GRAY;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::vector<std::uint8_t> bytes(size);
    if (pixels.size() != std::size_t(width) * std::size_t(height) ||
        !png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr))
        throw Error(ErrorCode::internal, std::string("a picture cannot be packed: ") +
                                             (image.message[0] ? image.message : "its size"));
    bytes.resize(size);
    return bytes;
}

}  // namespace palpate

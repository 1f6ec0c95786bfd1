// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

/// What `to_base64` packed.
std::vector<std::uint8_t> from_base64(const std::string& text);

struct GreyPixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> values;  ///< rows from the top

    std::uint8_t at(int column, int row) const {
        return values.at(std::size_t(row) * std::size_t(width) + std::size_t(column));
    }
};

/// What `png_of` packed; of width 0 if that is no PNG file.
GreyPixels from_png(const std::vector<std::uint8_t>& bytes);

}  // namespace palpate

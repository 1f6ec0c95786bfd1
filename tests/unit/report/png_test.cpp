// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/png.hpp"

#include <gtest/gtest.h>

#include "solver/base/error.hpp"
#include "tests/unit/report/unpacked.hpp"

namespace palpate {
namespace {

TEST(Png, HoldsEveryPixelAndNoText) {
    std::vector<std::uint8_t> pixels;
    for (int p = 0; p < 7 * 300; ++p) pixels.push_back(std::uint8_t(p * p));

    const std::vector<std::uint8_t> bytes = png_of(7, 300, pixels);

    const GreyPixels back = from_png(bytes);
    EXPECT_EQ(back.width, 7);
    EXPECT_EQ(back.height, 300);
    EXPECT_EQ(back.values, pixels);
    const std::string text(bytes.begin(), bytes.end());
    for (const char* chunk : {"tEXt", "iTXt", "zTXt", "tIME", "eXIf"})
        EXPECT_EQ(text.find(chunk), std::string::npos) << chunk;
}

TEST(Png, RefusesAnotherNumberOfPixels) {
    EXPECT_THROW(png_of(2, 2, std::vector<std::uint8_t>(3)), Error);
    EXPECT_THROW(png_of(0, 0, {}), Error);
}

}  // namespace
}  // namespace palpate

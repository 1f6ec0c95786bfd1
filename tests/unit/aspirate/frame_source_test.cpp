// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>

#include "host/apps/aspirate/frames/frame_source.hpp"
#include "host/apps/aspirate/frames/pgm_picture.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::vector<char> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

TEST(FrameSource, ReadsEightAndSixteenBits) {
    Index depth = 0;
    const GreyFrame eight = parse_pgm(bytes_of("P5 # a comment\n2 1\n255\n\x10\x20"), depth);
    EXPECT_EQ(eight.grey, (std::vector<float>{16, 32}));
    const GreyFrame sixteen =
        parse_pgm(bytes_of(std::string("P5\n2 1\n65535\n\xff\xff\x00\x00", 17)), depth);
    EXPECT_EQ(depth, 65535);
    EXPECT_FLOAT_EQ(sixteen.grey[0], 255);
    EXPECT_FLOAT_EQ(sixteen.grey[1], 0);
}

TEST(FrameSource, RefusesDamagedPictures) {
    Index depth = 0;
    for (const std::string text : {"", "P6\n1 1\n255\nabc", "P5\n2 2\n255\nab", "P5\n0 2\n255\n",
                                   "P5\n2 2\n70000\nabcdabcd", "P5\n2", "P5\n99999999999 1\n255\n"})
        EXPECT_THROW(parse_pgm(bytes_of(text), depth), Error) << text;
}

TEST(FrameSource, RawBytesComeFrameByFrameAndACutOneIsTold) {
    std::istringstream in("abcdefghij");
    FrameSource source(in, "2x2");
    GreyFrame frame;
    EXPECT_TRUE(source.next(frame));
    EXPECT_TRUE(source.next(frame));
    EXPECT_EQ(frame.grey[0], float('e'));
    try {
        source.next(frame);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unreadable);
        EXPECT_STREQ(error.what(), "frame 3 is cut: 2 of 4 bytes; check --raw");
    }
}

TEST(FrameSource, SizesThatAreNoneAndBlackFramesAreRefused) {
    std::istringstream in(std::string(8, '\0'));
    for (const char* size : {"2", "2x", "0x2", "2x2x2", "-1x3"})
        EXPECT_THROW(FrameSource(in, size), Error) << size;
    FrameSource source(in, "2x2");
    GreyFrame frame;
    try {
        source.next(frame);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
    }
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/packing.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

std::string base64_of(const std::string& text) {
    return to_base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Base64, AgreesWithTheVectorsOfRfc4648) {
    EXPECT_EQ(base64_of(""), "");
    EXPECT_EQ(base64_of("f"), "Zg==");
    EXPECT_EQ(base64_of("fo"), "Zm8=");
    EXPECT_EQ(base64_of("foo"), "Zm9v");
    EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
}

TEST(PackedFloats, AreLittleEndianAndFinite) {
    EXPECT_EQ(pack_floats({1.0}), "AACAPw==");
    EXPECT_EQ(pack_floats({NAN}), pack_floats({0.0}));
    EXPECT_EQ(pack_indices({1, 256}), "AQAAAAABAAA=");
}

TEST(ScaledNumbers, GoFromTheSmallestToTheLargestAndKnowWhatIsMissing) {
    const ScaledNumbers numbers = pack_scaled({-1, 1, 0, NAN});

    EXPECT_EQ(numbers.low, -1);
    EXPECT_EQ(numbers.high, 1);
    EXPECT_EQ(numbers.packed, base64_of(std::string("\0\0\xfe\xff\xff\x7f\xff\xff", 8)));
    EXPECT_EQ(pack_scaled({2, 2}).packed, base64_of(std::string(4, '\0')));
    EXPECT_EQ(pack_scaled({NAN}).low, 0);
}

TEST(RunLengths, HoldValueAndLengthWithSevenBitsAByte) {
    std::vector<std::uint8_t> values(300, 5);
    values.push_back(0);

    EXPECT_EQ(run_lengths(values), (std::vector<std::uint8_t>{5, 0xac, 0x02, 0, 1}));
    EXPECT_TRUE(run_lengths({}).empty());
}

}  // namespace
}  // namespace palpate

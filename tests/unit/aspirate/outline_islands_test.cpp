// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/apps/aspirate/contours/outline_islands.hpp"

namespace palpate {
namespace {

/// A letter for each column: o ok, g guessed, h hidden, l lost; an outline is 180 columns wide.
Outline outline_of(const std::string& letters) {
    Outline outline(180, {10, 0.1, PointFlag::ok});
    for (std::size_t k = 0; k < letters.size(); ++k) {
        outline[k].flag = letters[k] == 'o'   ? PointFlag::ok
                          : letters[k] == 'g' ? PointFlag::guessed
                          : letters[k] == 'h' ? PointFlag::hidden
                                              : PointFlag::lost;
        outline[k].sd = letters[k] == 'o' ? 0.1 : 2.0;
    }
    return outline;
}

std::string flagged(const std::string& letters) {
    Outline outline = outline_of(letters);
    flag_islands(outline);
    std::string after;
    for (std::size_t k = 0; k < letters.size(); ++k) after += "oghl"[int(outline[k].flag)];
    return after;
}

TEST(OutlineIslands, AreDoubtedAsWhatSurroundsThem) {
    EXPECT_EQ(flagged("ooooogggooggggooooo"), "ooooogggggggggooooo");
    EXPECT_EQ(flagged("hhggoogggggooooo"), "hhgggggggggooooo");
    EXPECT_EQ(flagged("ooooollloogggooooo"), "ooooolllgggggooooo");
}

TEST(OutlineIslands, HaveTheErrorOfTheirNeighbours) {
    Outline outline = outline_of("ooooogggooggggooooo");
    flag_islands(outline);
    EXPECT_EQ(outline[8].sd, 2.0);
    EXPECT_EQ(outline[4].sd, 0.1);
}

TEST(OutlineIslands, AreNoneWhereMoreAgreeThanDisagree) {
    for (const std::string letters : {"ooooogggooooogggooooo",  // too wide
                                      "oooooggooggooooo",       // hardly anything beside it
                                      "hhhooggggooooo",         // an edge of what is hidden
                                      "oooooooo"})
        EXPECT_EQ(flagged(letters), letters);
}

/// Tissue from row 10 down, but rows 25 to 34 of columns 0 to `gap` are background.
std::string floating(const std::string& letters, int gap, float grey = 0.5F) {
    constexpr Index rows = 60;
    Outline outline = outline_of(letters);
    std::vector<float> beyond(std::size_t(180 * rows), 50.0F);
    const std::vector<float> tissue(180, 50.0F);
    for (std::size_t x = 0; x < 180; ++x)
        for (std::size_t y = 0; y < rows; ++y)
            if (y < 10 || (y >= 25 && y < 35 && int(x) < gap))
                beyond[x * rows + y] = y < 10 ? 0 : grey;
    flag_floating({beyond, rows, rows, 1, tissue}, outline);
    std::string after;
    for (std::size_t k = 0; k < letters.size(); ++k) after += "oghl"[int(outline[k].flag)];
    return after;
}

TEST(OutlinesThatFloat, AreDoubtedBesideAsManyDoubted) {
    const std::string before = "hhgggggoooooooooggggooooo", after = "hhggggggggggggggggggooooo";
    EXPECT_EQ(floating(before, 16), after);
    EXPECT_EQ(floating(before, 13), after);  // most of the run
    // two bubbles: the second one's run is longer than what is doubted before the first one's is
    EXPECT_EQ(floating("hhgooooooogoooggggoooooo", 14), "hhggggggggggggggggoooooo");
}

TEST(OutlinesThatFloat, AreNoneOverTissueOrWithoutDoubt) {
    const std::string before = "hhgggggoooooooooggggooooo";
    EXPECT_EQ(floating(before, 10), before);      // few of the run
    EXPECT_EQ(floating(before, 16, 30), before);  // dark tissue
    for (const std::string few : {"hhggggooooooooogggoooooo", "hhhhooooooooohhhhhhh"})
        EXPECT_EQ(floating(few, 16), few);
}

TEST(OutlinesThatFloat, AreNoneWhereTissueGrowsDarkWithDepth) {
    constexpr Index rows = 90;
    const std::vector<float> tissue(180, 50.0F);
    for (const double fall : {0.01, 0.02, 0.03, 0.05}) {  // of the light, per row
        std::vector<float> beyond(std::size_t(180 * rows), 0.0F);
        for (std::size_t x = 0; x < 180; ++x)
            for (std::size_t y = 10; y < rows; ++y)
                beyond[x * rows + y] = float(55 * std::exp(-fall * double(y - 10)));
        Outline outline = outline_of("hhgggggoooooooooggggooooo");
        const Outline before = outline;
        flag_floating({beyond, rows, rows, 1, tissue}, outline);
        for (std::size_t x = 0; x < outline.size(); ++x)
            EXPECT_EQ(outline[x].flag, before[x].flag) << fall;
    }
}

/// A parabola 50 rows high over 150 columns, with a bite of `depth` rows from column 60 to 79.
Outline cap_with_bite(double depth) {
    Outline outline(180, {101, 0.1, PointFlag::hidden});
    for (std::size_t x = 15; x < 165; ++x) {
        const double s = (double(x) - 90) / 75;
        outline[x] = {50 + 50 * s * s + (x >= 60 && x < 80 ? depth : 0), 0.1, PointFlag::ok};
    }
    return outline;
}

std::size_t num_doubted(const Outline& outline) {
    return std::size_t(std::count_if(outline.begin(), outline.end(), [](const OutlinePoint& point) {
        return is_doubted(point.flag);
    }));
}

TEST(OutlinesWithABite, AreDoubtedThere) {
    Outline outline = cap_with_bite(5);
    flag_bites(100, outline);
    for (std::size_t x = 62; x < 78; ++x) EXPECT_EQ(outline[x].flag, PointFlag::guessed) << x;
    EXPECT_LE(num_doubted(outline), 24u);
    EXPECT_GT(outline[70].sd, 3);
}

TEST(OutlinesWithABite, AreNoneThatBulge) {
    Outline outline = cap_with_bite(0);
    flag_bites(100, outline);
    EXPECT_EQ(num_doubted(outline), 0u);
    outline = cap_with_bite(1);  // shallow
    flag_bites(100, outline);
    EXPECT_EQ(num_doubted(outline), 0u);
    // a skirt that bends the other way beside the line of visibility
    for (std::size_t x = 15; x < 165; ++x)
        outline[x] = {100 - 60 * std::exp(-std::pow((double(x) - 90) / 30, 2)), 0.1, PointFlag::ok};
    flag_bites(100, outline);
    EXPECT_EQ(num_doubted(outline), 0u);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/axis_finder.hpp"

#include <gtest/gtest.h>

#include <string>

#include "host/apps/aspirate/profile_writer.hpp"

namespace palpate {
namespace {

AspirationInstrument instrument(const std::string& more = "") {
    return parse_aspiration_settings(
               "[instrument]\nhole_diameter_mm = 10\nedge_radius_mm = 0.2\n"
               "rim_thickness_mm = 0.5\npixel_r_um = 60\npixel_z_um = 30\nbase_row_px = 150\n" +
                   more + "[frames]\nrate_hz = 25\n",
               "film.toml", {}, AspirationPart::camera)
        .instrument;
}

constexpr std::size_t width = 180;

/// A cap about column 70; nothing above row 130 where it has not come up.
Outline cap(bool is_up) {
    Outline outline(width, {130, 0.1, PointFlag::hidden});
    for (std::size_t x = 10; is_up && x < 130; ++x) {
        const double s = (double(x) - 70) / 83;
        outline[x] = {110 + 40 * s * s, 0.1, PointFlag::ok};
    }
    return outline;
}

TEST(AxisFinder, WaitsForTissue) {
    AxisFinder finder(instrument());
    for (int k = 0; k < 30; ++k) finder.add(cap(false));
    EXPECT_FALSE(finder.is_known());
    EXPECT_FALSE(finder.is_settled());
    EXPECT_EQ(finder.column(), 89.5);
    finder.add(cap(true));
    EXPECT_TRUE(finder.is_known());
    EXPECT_FALSE(finder.is_settled());
    for (int k = 0; k < 9; ++k) finder.add(cap(true));
    EXPECT_TRUE(finder.is_settled());
    EXPECT_NEAR(finder.column(), 70, 0.1);
    EXPECT_LT(finder.sides_about(70).asymmetry_mm, 0.005);
    EXPECT_GT(finder.sides_about(70).num_pairs, 100);
}

TEST(AxisFinder, ATakenColumnStaysAndItsSidesAreCompared) {
    AxisFinder finder(instrument("axis_column_px = 75\n"));
    EXPECT_TRUE(finder.is_settled());
    for (int k = 0; k < 3; ++k) finder.add(cap(true));
    EXPECT_EQ(finder.column(), 75);
    EXPECT_GT(finder.sides_about(75).asymmetry_mm, 0.05);
}

TEST(ProfileWriter, AfterTwoThousandFramesWithoutTissueTheMiddleStaysTheAxis) {
    ProfileWriter writer(instrument(), [](const std::string&) {});
    for (int k = 0; k < 2000; ++k) writer.add(cap(false), 0.04 * k);
    for (int k = 2000; k < 2020; ++k) writer.add(cap(true), 0.04 * k);
    writer.finish();
    EXPECT_EQ(writer.axis().column, 89.5);
    EXPECT_FALSE(writer.axis().is_known);
    EXPECT_GT(writer.axis().asymmetry_mm, 0.1);
}

TEST(ProfileWriter, RowsOfFramesBeforeTissueCameWaitForTheAxis) {
    std::string text;
    ProfileWriter writer(instrument(), [&](const std::string& rows) { text += rows; });
    const std::string head = text;
    for (int k = 0; k < 20; ++k) writer.add(cap(false), 0.04 * k);
    EXPECT_EQ(text, head);
    for (int k = 20; k < 30; ++k) writer.add(cap(true), 0.04 * k);
    EXPECT_NEAR(writer.axis().column, 70, 0.1);
    EXPECT_TRUE(writer.axis().is_known);
    EXPECT_NE(text.find("\n0.0000,"), std::string::npos);
    EXPECT_NE(text.find("\n1.1600,"), std::string::npos);
}

TEST(ProfileWriter, WithoutTissueTheMiddleIsTheAxisAndItSaysSo) {
    std::string text;
    ProfileWriter writer(instrument(), [&](const std::string& rows) { text += rows; });
    for (int k = 0; k < 3; ++k) writer.add(cap(false), 0.04 * k);
    writer.finish();
    EXPECT_EQ(writer.axis().column, 89.5);
    EXPECT_FALSE(writer.axis().is_known);
    EXPECT_NE(text.find("\n0.0800,"), std::string::npos);
}

}  // namespace
}  // namespace palpate

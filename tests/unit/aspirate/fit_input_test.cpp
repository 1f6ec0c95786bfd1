// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/fit_input.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <string>

#include "host/apps/aspirate/profile_axis.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

constexpr double begin_s = 1, peak_kpa = 2;

AspirationSettings settings() {
    return parse_aspiration_settings(
        "[instrument]\nhole_diameter_mm = 10\nedge_radius_mm = 0.2\nrim_thickness_mm = 0.5\n"
        "pixel_r_um = 60\npixel_z_um = 30\nbase_row_px = 150\n[frames]\nrate_hz = 25\n",
        "film.toml", {}, AspirationPart::tissue);
}

Suction suction() { return {{0, begin_s, 3, 5, 7, 10}, {0, 0, peak_kpa, peak_kpa, 0, 0}}; }

/// A cap that comes up by 0.3 mm a kPa; `noise` alternates from frame to frame.
ProfileSeries film(double noise_mm) {
    ProfileSeries frames;
    for (int k = 0; k < 250; ++k) {
        FrameProfile frame;
        frame.time_s = k / 25.0;
        const double up_mm = 0.3 * suction().at(frame.time_s) + (k % 2 == 0 ? noise_mm : -noise_mm);
        for (double r = -4.9; r < 4.95; r += 0.06)
            frame.points.push_back({r, 1.2 * (1 - r * r / 27) + up_mm, 0.01});
        frames.push_back(frame);
    }
    return frames;
}

TEST(FitInput, FramesBeforeSuctionAreOneRowOfMeansAtTheirMeanTime) {
    const AspirationFitInput input = make_fit_input(film(0.02), suction(), settings());

    EXPECT_EQ(input.begin_s, begin_s);
    const double first_s = input.points.front().time_s;
    EXPECT_NEAR(first_s, -0.5, 0.03);
    int num_rest = 0;
    for (const ThinPoint& point : input.points) {
        if (point.time_s != first_s) {
            EXPECT_GT(point.time_s, 0);
            continue;
        }
        ++num_rest;
        // single frames are off by 0.02 mm
        EXPECT_NEAR(point.z_mm, 1.2 * (1 - point.r_mm * point.r_mm / 27), 0.003);
        EXPECT_NEAR(point.sd_mm, 0.01, 1e-9);
    }
    EXPECT_GE(num_rest, 11);
    EXPECT_EQ(std::count_if(input.points.begin(), input.points.end(),
                            [&](const ThinPoint& point) { return point.time_s < first_s; }),
              0);
}

TEST(FitInput, HeightsBesideTheWallAreThoseOfACurvedProfile) {
    ProfileSeries frames = film(0);
    // 0.5 / mm of curvature at r = 4.5 mm as sucked tissue has it beside the wall
    const auto bent = [](double r) { return -0.25 * std::pow(std::max(0.0, std::abs(r) - 4), 2); };
    for (FrameProfile& frame : frames)
        for (ProfilePoint& point : frame.points) point.z_mm += bent(point.r_mm);
    const AspirationFitInput input = make_fit_input(frames, suction(), settings());

    int num_beside = 0;
    for (const ThinPoint& point : input.points)
        if (std::abs(std::abs(point.r_mm) - 4.5) < 1e-9 && point.time_s > 2.5 &&
            point.time_s < 3.5) {
            ++num_beside;
            const double up_mm = 0.3 * suction().at(point.time_s + begin_s);
            const double z_mm = 1.2 * (1 - 4.5 * 4.5 / 27) + bent(4.5) + up_mm;
            EXPECT_NEAR(point.z_mm, z_mm, 2e-4);  // a straight line is 6e-3 off
        }
    EXPECT_GE(num_beside, 8);
}

ProfileSeries moved(ProfileSeries frames, double by_mm) {
    move_axis(-by_mm, frames);
    return frames;
}

using Profiles = TemporaryFolderTest;

TEST_F(Profiles, AreFromLeftToRightInWhateverOrderTheirTableIs) {
    const auto path = folder / "profiles.csv";
    std::ofstream(path) << "time_s,r_mm,z_mm,sd_mm\n0,2,1.2,0.01\n0,-1,1.1,0.01\n0,0.5,1.3,0.01\n"
                           "1,0,1.4,0.01\n1,-3,1.0,0.01\n";
    const ProfileSeries frames = read_profiles(path);
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[0].points[0].z_mm, 1.1);
    EXPECT_EQ(frames[0].points[2].z_mm, 1.2);
    EXPECT_EQ(frames[1].points[0].r_mm, -3);
}

constexpr double radius_mm = 5;

/// Cap and rise of other heights, and a camera that is turned.
ProfileSeries other_film(double cap_mm, double rise_mm, double slope) {
    ProfileSeries frames = film(0);
    for (FrameProfile& frame : frames)
        for (ProfilePoint& point : frame.points) {
            const double r = point.r_mm;
            point.z_mm =
                (cap_mm + rise_mm * suction().at(frame.time_s)) * (1 - r * r / 27) + slope * r;
        }
    return frames;
}

TEST(ProfileAxis, IsWhereBothSidesAreMostAlikeInMostFrames) {
    EXPECT_EQ(axis_of(film(0.02), radius_mm), 0);
    ProfileSeries frames = moved(other_film(1, 0.3, 0), 0.46);
    EXPECT_NEAR(axis_of(frames, radius_mm), 0.46, 1e-9);
    // a bubble on the right in a third of the frames
    for (std::size_t k = 0; k < frames.size() / 3; ++k)
        for (ProfilePoint& point : frames[k].points)
            if (point.r_mm > 2 && point.r_mm < 4) point.z_mm += 0.5;
    EXPECT_NEAR(axis_of(frames, radius_mm), 0.46, 1e-9);
}

TEST(ProfileAxis, IsNotMovedByATurnedCamera) {
    for (const double slope : {0.01, -0.03}) {
        EXPECT_EQ(axis_of(other_film(1.2, 0.3, slope), radius_mm), 0);
        EXPECT_NEAR(axis_of(moved(other_film(1.2, 0.3, slope), 0.3), radius_mm), 0.3, 1e-9);
    }
}

TEST(ProfileAxis, IsNotMovedByATubeThatIsAskew) {
    for (const double slope : {0.08, 0.15, 0.23, 0.26, -0.3})
        for (const double cap_mm : {1.2, 2.0})
            EXPECT_EQ(axis_of(other_film(cap_mm, 0.3, slope), radius_mm), 0) << slope;
}

TEST(ProfileAxis, IsNotMovedByNoiseWhereATurnedCameraSaysAsMuch) {
    std::mt19937 engine(3);
    std::normal_distribution<double> noise(0, 0.01);
    for (const double cap_mm : {1.2, 1.6, 2.0})
        for (int round = 0; round < 4; ++round) {
            ProfileSeries frames = other_film(cap_mm, 0.1, 0.05);
            for (FrameProfile& frame : frames)
                for (ProfilePoint& point : frame.points) point.z_mm += noise(engine);
            EXPECT_NEAR(axis_of(frames, radius_mm), 0, 0.1) << cap_mm;
        }
}

/// Ten frames of tissue at rest, as profiles about another axis, with a bubble beside it.
TEST(ProfileAxis, OfAFewFramesIsNotDrawnByABubble) {
    for (const double up_mm : {0.0, 0.1, 0.25, 0.5})
        for (const double off_mm : {-1.1, 0.33}) {
            ProfileSeries frames = moved(other_film(1.2, 0, 0), off_mm);
            frames.resize(10);
            for (FrameProfile& frame : frames)
                for (ProfilePoint& point : frame.points)
                    if (point.r_mm - off_mm > 1.5 && point.r_mm - off_mm < 3) point.z_mm += up_mm;
            const ProfileAxis found = find_axis(frames, radius_mm);
            EXPECT_NEAR(found.r_mm, off_mm, 0.03);
            EXPECT_GT(found.num_pairs, 100);
            EXPECT_NEAR(found.asymmetry_mm, 0.28 * up_mm, 0.1 * up_mm + 1e-3);
        }
    // level tissue, and a frame three times as wide as the hole
    FrameProfile level, wide;
    for (double r = -4.5; r < 4.55; r += 0.06) level.points.push_back({r, 1, 0.01});
    EXPECT_EQ(find_axis({level}, radius_mm).r_mm, 0);
    for (double r = -15; r < 15; r += 0.06)
        wide.points.push_back({r, 1.2 * (1 - (r - 4) * (r - 4) / 27), 0.01,
                               std::abs(r - 4) < 4.5 ? PointFlag::ok : PointFlag::hidden});
    EXPECT_NEAR(find_axis({wide}, radius_mm).r_mm, 4, 0.03);
    const ProfileAxis nothing = find_axis({{0, {}}}, radius_mm);
    EXPECT_EQ(nothing.r_mm, 0);
    EXPECT_EQ(nothing.num_pairs, 0);
}

/// A wrong axis is hardly told from a camera that is turned by 0.08, which none is.
TEST(ProfileAxis, IsMovedWhereTissueHardlyRises) {
    EXPECT_NEAR(axis_of(moved(other_film(1.2, 0.05, 0), -0.6), radius_mm), -0.6, 1e-9);
}

TEST(ProfileAxis, StaysWhereASideTellsNothing) {
    for (const double rise_mm : {0.1, 0.3, 0.6}) {
        const ProfileSeries frames = other_film(0.6, rise_mm, 0);
        for (const double seen_to_mm : {0.0, 0.5, 1.5}) {
            ProfileSeries flagged = frames, one_sided = frames;
            for (FrameProfile& frame : flagged)
                for (ProfilePoint& point : frame.points)
                    if (point.r_mm > seen_to_mm) point.flag = PointFlag::guessed;
            for (FrameProfile& frame : one_sided)
                std::erase_if(frame.points,
                              [&](const ProfilePoint& point) { return point.r_mm < -seen_to_mm; });
            EXPECT_EQ(axis_of(flagged, radius_mm), 0) << rise_mm << ' ' << seen_to_mm;
            EXPECT_EQ(axis_of(one_sided, radius_mm), 0) << rise_mm << ' ' << seen_to_mm;
        }
    }
}

TEST(FitInput, AnAxisThatIsFarOffIsMovedUnlessItIsTold) {
    const AspirationFitInput input =
        make_fit_input(moved(other_film(1.2, 0.3, 0), 0.5), suction(), settings());
    EXPECT_LT(input.asymmetry_mm, 0.001);
    ASSERT_EQ(input.warnings.size(), 1u);
    EXPECT_NE(input.warnings[0].find("r = 0.50 mm"), std::string::npos) << input.warnings[0];

    // within what is believed it stays, or where a camera that is turned does as well
    const AspirationFitInput near =
        make_fit_input(moved(other_film(1.2, 0.3, 0), 0.08), suction(), settings());
    EXPECT_GT(near.asymmetry_mm, 0.01);
    EXPECT_TRUE(near.warnings.empty());

    AspirationSettings told = settings();
    told.instrument.axis_column_px = 90;
    const AspirationFitInput as_told =
        make_fit_input(moved(other_film(1.2, 0.3, 0), 0.5), suction(), told);
    EXPECT_GT(as_told.asymmetry_mm, 0.05);
}

TEST(FitInput, ProfilesOfFewPointsHaveWiderBins) {
    const auto every = [](int step) {
        ProfileSeries frames = film(0);
        for (FrameProfile& frame : frames) {
            std::vector<ProfilePoint> few;
            for (std::size_t k = 0; k < frame.points.size(); k += std::size_t(step))
                few.push_back(frame.points[k]);
            frame.points = few;
        }
        return frames;
    };
    const AspirationFitInput usual = make_fit_input(every(1), suction(), settings());
    for (const int step : {2, 3}) {  // 0.12 and 0.18 mm
        const AspirationFitInput input = make_fit_input(every(step), suction(), settings());
        EXPECT_EQ(input.num_used_frames, usual.num_used_frames);
        EXPECT_GT(input.points.size(), usual.points.size() / 3);
        EXPECT_NEAR(input.seen_later_to_mm, usual.seen_later_to_mm, 0.5);
        for (const ThinPoint& point : input.points)
            if (point.time_s > 2.5 && point.time_s < 3.5) {
                const double up_mm = 0.3 * suction().at(point.time_s + begin_s);
                const double z_mm = 1.2 * (1 - point.r_mm * point.r_mm / 27) + up_mm;
                EXPECT_NEAR(point.z_mm, z_mm, 1e-3);
            }
    }
    try {
        make_fit_input(every(4), suction(), settings());
        FAIL() << "it was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("0.24 mm apart"), std::string::npos)
            << error.what();
    }
}

TEST(FitInput, WithoutAFrameBeforeSuctionNothingCanBeFitted) {
    ProfileSeries frames = film(0);
    frames.erase(frames.begin(), frames.begin() + 40);
    try {
        make_fit_input(frames, suction(), settings());
        FAIL() << "it was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("begin to film earlier"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate

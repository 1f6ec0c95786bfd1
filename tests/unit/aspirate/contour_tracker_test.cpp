// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <new>

#include "host/apps/aspirate/contours/contour_tracker.hpp"
#include "host/apps/aspirate/contours/published_outline.hpp"
#include "host/apps/study/aspiration_film.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr Index num_frames = 12;

ContourSettings settings_of(const AspirationFilm& film, bool is_brighter = true) {
    return {film.width(), film.height(), film.visible_rows(), is_brighter};
}

GreyFrame frame_of(const AspirationFilm& film, Index number, bool is_negative = false) {
    const auto grey = film.frame(number);
    GreyFrame frame{film.width(), film.height(), {grey.begin(), grey.end()}};
    if (is_negative)
        for (float& value : frame.grey) value = 255 - value;
    return frame;
}

/// Points without a flag: root mean square error, share beyond 3 pixels, and share of flags.
struct Errors {
    double squares = 0;
    int near = 0, wrong = 0, flagged = 0, all = 0;
    double rms() const { return std::sqrt(squares / near); }
};

template <class Finder>
Errors errors_of(const AspirationFilm& film, Finder& finder) {
    Errors errors;
    for (Index k = 0; k < film.num_frames(); ++k) {
        const Outline& found = finder.add(frame_of(film, k));
        const auto truth = film.outline(k);
        for (Index x = 4; x < film.width() - 4; ++x) {
            if (truth[x] > film.visible_rows() - 6) continue;
            ++errors.all;
            const double error = found[x].row - truth[x];
            if (found[x].flag != PointFlag::ok)
                ++errors.flagged;
            else if (std::abs(error) > 3)
                ++errors.wrong;
            else {
                ++errors.near;
                errors.squares += error * error;
            }
        }
    }
    return errors;
}

TEST(ContourTracker, FollowsCleanTissueToATenthOfAPixel) {
    const AspirationFilm film(film_suite()[0], 31, num_frames);
    ContourTracker tracker(settings_of(film));

    const Errors errors = errors_of(film, tracker);

    EXPECT_LT(errors.rms(), 0.15);
    EXPECT_EQ(errors.wrong, 0);
    EXPECT_LT(errors.flagged, 0.05 * errors.all);
}

TEST(ContourTracker, SeesThroughNoiseInFallingLight) {
    const AspirationFilm film(film_suite()[1], 32, num_frames);
    ContourTracker tracker(settings_of(film));

    const Errors errors = errors_of(film, tracker);

    EXPECT_LT(errors.rms(), 0.5);
    EXPECT_LT(errors.wrong, 0.003 * errors.all);
}

TEST(ContourTracker, IsNotDrawnByGlareAsThePublishedMethodIs) {
    const AspirationFilm film(film_suite()[2], 33, num_frames);
    ContourTracker tracker(settings_of(film));
    PublishedOutline published(settings_of(film));

    const Errors ours = errors_of(film, tracker), theirs = errors_of(film, published);

    EXPECT_LT(ours.wrong, 0.01 * ours.all);
    EXPECT_GT(theirs.wrong, ours.wrong);
}

TEST(ContourTracker, DarkTissueBeforeALightBackgroundIsTheSame) {
    const AspirationFilm film(film_suite()[0], 34, 2);
    ContourTracker bright(settings_of(film)), dark(settings_of(film, false));

    const Outline a = bright.add(frame_of(film, 0)), b = dark.add(frame_of(film, 0, true));

    for (std::size_t x = 0; x < a.size(); ++x) EXPECT_NEAR(a[x].row, b[x].row, 1e-6);
}

TEST(ContourTracker, WhatIsBehindTheRimIsHidden) {
    const AspirationFilm film(film_suite()[0], 35, 2);
    ContourTracker tracker(settings_of(film));

    const Outline& outline = tracker.add(frame_of(film, 0));

    EXPECT_EQ(outline[5].flag, PointFlag::hidden);
    EXPECT_EQ(outline[90].flag, PointFlag::ok);
}

TEST(ContourTracker, AFrameOfAnotherSizeIsRefused) {
    const AspirationFilm film(film_suite()[0], 36, 1);
    ContourTracker tracker(settings_of(film));

    try {
        tracker.add({90, 180, std::vector<float>(90 * 180)});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_STREQ(error.what(), "a frame of 90 x 180 pixels among frames of 180 x 180");
    }
}

TEST(ContourTracker, AFrameWithoutTissueHasNoOutline) {
    const AspirationFilm film(film_suite()[0], 37, 1);
    ContourTracker tracker(settings_of(film));

    const Outline& outline = tracker.add({180, 180, std::vector<float>(180 * 180, 30.0F)});

    for (const OutlinePoint& point : outline) EXPECT_NE(point.flag, PointFlag::ok);
}

}  // namespace
}  // namespace palpate

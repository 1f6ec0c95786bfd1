// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/rest_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/apps/aspirate/tissue_experiment.hpp"

namespace palpate {
namespace {

constexpr double hole_mm = 5, edge_mm = 0.2, lowest_mm = 0.5, cap_mm = 1.2;

double cap_at(double r_mm) { return cap_mm * (1 - r_mm * r_mm / 27.04); }  // 0 at 5.2 mm

/// Frames of a cap that is seen above the line of visibility.
std::vector<FrameProfile> frames_of_cap() {
    FrameProfile frame;
    for (double r = -5; r <= 5; r += 0.05)
        if (cap_at(r) > lowest_mm) frame.points.push_back({r, cap_at(r), 0.01});
    return {3, frame};
}

TEST(RestSurface, IsTheCapWhereItIsSeenAndEndsAtTheRim) {
    const FoundRest found = find_rest(frames_of_cap(), lowest_mm, hole_mm, edge_mm);

    ASSERT_TRUE(found.is_seen);
    const double line_mm = std::sqrt(27.04 * (1 - lowest_mm / cap_mm));
    EXPECT_NEAR(found.seen_to_mm, line_mm, 0.1);
    for (std::size_t k = 0; k < found.surface.r_mm.size(); ++k)
        if (found.surface.r_mm[k] < found.seen_to_mm) {
            EXPECT_NEAR(found.surface.z_mm[k], cap_at(found.surface.r_mm[k]), 0.01);
        }
    EXPECT_EQ(found.surface.z_mm.back(), 0);
}

TEST(RestSurface, ABubbleBesideTheCapIsNotTakenForSeenTissue) {
    std::vector<FrameProfile> frames = frames_of_cap();
    const double before = find_rest(frames, lowest_mm, hole_mm, edge_mm).seen_to_mm;
    for (double r = 4.5; r < 4.7; r += 0.05) frames[0].points.push_back({r, 0.8, 0.01});

    const FoundRest found = find_rest(frames, lowest_mm, hole_mm, edge_mm);

    EXPECT_NEAR(found.seen_to_mm, before, 0.05);
}

TEST(RestSurface, HiddenHeightsComeDownNoSteeperThanAHalfRightAngle) {
    EXPECT_EQ(hidden_height(5.0, 0.9, 5.2), 5.2 - 5.0);
    EXPECT_EQ(hidden_height(5.0, 0.1, 5.2), 0.1);
    EXPECT_EQ(hidden_height(5.0, -0.1, 5.2), 0);
}

class MovedRest : public testing::Test {
protected:
    MovedRest() {
        for (double r = 0; r < 5.3; r += 0.2) {
            sucked.rest.r_mm.push_back(r);
            sucked.rest.z_mm.push_back(std::max(0.0, 0.5 * cap_at(r)));
        }
        sucked.rest.r_mm.back() = 5.2;
        sucked.seen_to_mm = 3.2;
        sucked.seen_later_to_mm = 4.7;  // hidden places at 3.7, 4.2 and 4.7 mm
    }
    double height_at(double r_mm) const {
        for (std::size_t k = 0; k < sucked.rest.r_mm.size(); ++k)
            if (std::abs(sucked.rest.r_mm[k] - r_mm) < 1e-9) return sucked.rest.z_mm[k];
        ADD_FAILURE() << "no point at " << r_mm;
        return 0;
    }

    SuckedBody sucked;
};

TEST_F(MovedRest, MovesTheHiddenPartAndNothingElse) {
    const RestSurface before = sucked.rest;

    move_rest(sucked, {0.05, 0.1, 0});

    for (std::size_t k = 0; k < before.r_mm.size(); ++k)
        if (before.r_mm[k] <= 3.2) {
            EXPECT_EQ(sucked.rest.z_mm[k], before.z_mm[k]);
        }
    EXPECT_NEAR(height_at(4.2), 0.5 * cap_at(4.2) + 0.1, 1e-9);
    EXPECT_NEAR(height_at(3.4), 0.5 * cap_at(3.4) + 0.05 * 0.2 / 0.5, 1e-9);
    EXPECT_EQ(sucked.rest.z_mm.back(), before.z_mm.back());
}

TEST_F(MovedRest, CountsFromTheFirstGuess) {
    move_rest(sucked, {0.05, 0.1, 0});
    move_rest(sucked, {0.01, -0.02, 0.03});

    ASSERT_EQ(sucked.moved_mm.size(), 3u);
    EXPECT_NEAR(sucked.moved_mm[0], 0.06, 1e-12);
    EXPECT_NEAR(sucked.moved_mm[1], 0.08, 1e-12);
    EXPECT_NEAR(sucked.moved_mm[2], 0.03, 1e-12);
    EXPECT_NEAR(height_at(4.2), 0.5 * cap_at(4.2) + 0.08, 1e-9);
}

/// What the rim or 45 degrees forbid has not moved, however often it is asked for.
TEST_F(MovedRest, CountsNoFartherThanItMoved) {
    const double before_mm = height_at(4.2);
    for (int round = 0; round < 4; ++round) move_rest(sucked, {-0.1, -0.2, -0.3});

    EXPECT_NEAR(sucked.moved_mm[1], height_at(4.2) - before_mm, 0.01);
    EXPECT_GT(sucked.moved_mm[2], -0.5 * cap_at(4.6));  // it has gone no lower than the rim
    EXPECT_LT(sucked.moved_mm[2], -0.05);
}

TEST_F(MovedRest, NeverCountsMoreThanWasAskedFor) {
    std::mt19937 engine(5);
    std::normal_distribution<double> normal(0, 0.1);
    for (int round = 0; round < 2000; ++round) {
        SuckedBody body = sucked;
        const std::vector<double> by_mm{normal(engine), normal(engine), normal(engine)};
        move_rest(body, by_mm);
        for (std::size_t k = 0; k < by_mm.size(); ++k)
            EXPECT_LE(std::abs(body.moved_mm[k]), std::abs(by_mm[k]) + 1e-12);
    }
}

TEST_F(MovedRest, ComesDownToTheEndOfTheRimAndNoLower) {
    move_rest(sucked, {0, 0, 3});
    for (std::size_t k = 0; k < sucked.rest.r_mm.size(); ++k)
        EXPECT_LE(sucked.rest.z_mm[k], 5.2 - sucked.rest.r_mm[k] + 1e-12);

    move_rest(sucked, {0, 0, -9});
    for (const double z : sucked.rest.z_mm) EXPECT_GE(z, 0);
}

TEST_F(MovedRest, FallsOutwardsAtMostBy45Degrees) {
    // up at 4.2 mm and down at 4.7 mm, by more than a tissue can
    const double moved_mm = move_rest(sucked, {0, 0.4, -0.4});
    const RestSurface& rest = sucked.rest;
    for (std::size_t k = 1; k < rest.r_mm.size(); ++k) {
        if (rest.r_mm[k - 1] <= 3.2) continue;
        EXPECT_LE(rest.z_mm[k], rest.z_mm[k - 1] + 1e-12);
        EXPECT_LE(rest.z_mm[k - 1] - rest.z_mm[k], rest.r_mm[k] - rest.r_mm[k - 1] + 1e-12);
    }
    EXPECT_GT(moved_mm, 0.05);

    EXPECT_NEAR(move_rest(sucked, {0, 0, 0}), 0, 1e-12);  // it is so already
}

TEST_F(MovedRest, IsHardlyHigherThanALineToTheRimBeyondTheLastPlace) {
    for (std::size_t k = 0; k + 1 < sucked.rest.r_mm.size(); ++k)  // a guess that stands too high
        if (sucked.rest.r_mm[k] > 4.7) sucked.rest.z_mm[k] = 5.2 - sucked.rest.r_mm[k];

    move_rest(sucked, {0, 0, -0.05});

    const double at_46 = height_at(4.6);
    EXPECT_GT(at_46, 0.02);
    EXPECT_GT(height_at(4.8), 0);
    EXPECT_LE(height_at(4.8), 1.1 * at_46 * (5.2 - 4.8) / (5.2 - 4.6) + 1e-12);
    EXPECT_LE(height_at(5.0), 1.1 * at_46 * (5.2 - 5.0) / (5.2 - 4.6) + 1e-12);
}

}  // namespace
}  // namespace palpate

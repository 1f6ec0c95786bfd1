// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/plane_section.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/surfaces/analytic_surfaces.hpp"

namespace palpate {
namespace {

TEST(PlaneSection, OfASphereIsOneClosedCircle) {
    const double radius = 10, height = 3;
    const Surface sphere = testing::sphere_surface(Vec3(1, 2, 3), radius, 24);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 centre(1, 2, 3);
        const auto lines = plane_section(sphere, axis, centre[axis] + height);
        ASSERT_EQ(lines.size(), 1u);
        EXPECT_EQ(lines[0].front(), lines[0].back());
        const double expected = std::sqrt(radius * radius - height * height);
        double length = 0;
        for (std::size_t k = 0; k < lines[0].size(); ++k) {
            EXPECT_NEAR(lines[0][k][axis], centre[axis] + height, 1e-9);
            Vec3 across = lines[0][k] - centre;
            across[axis] = 0;
            EXPECT_NEAR(across.norm(), expected, 0.1);
            if (k > 0) length += (lines[0][k] - lines[0][k - 1]).norm();
        }
        EXPECT_NEAR(length, 2 * M_PI * expected, 0.02 * length);
    }
    EXPECT_TRUE(plane_section(sphere, 0, 12).empty());
    EXPECT_TRUE(plane_section({}, 0, 0).empty());
}

TEST(PlaneSection, ThinnedStaysWithinTheTolerance) {
    SectionLine line;
    for (int k = 0; k <= 100; ++k) {
        const double turn = 2 * M_PI * k / 100;
        line.emplace_back(10 * std::cos(turn), 10 * std::sin(turn), 0);
    }
    const SectionLine few = thinned(line, 0.2);
    EXPECT_LT(few.size(), 30u);
    EXPECT_EQ(few.front(), line.front());
    EXPECT_EQ(few.back(), line.back());
    for (std::size_t k = 1; k < few.size(); ++k)  // the middle of a chord lies inside the circle
        EXPECT_GT((few[k] + few[k - 1]).norm() / 2, 10 - 0.21);
    EXPECT_EQ(thinned({{0, 0, 0}, {1, 0.01, 0}, {2, 0, 0}}, 0.1).size(), 2u);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/anatomy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/apps/phantom/wall_motion.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

class AnatomyOfSeed : public testing::TestWithParam<unsigned> {};

TEST_P(AnatomyOfSeed, HasOrgansOfHumanSizeWithTissueAroundThem) {
    const PelvisAnatomy anatomy = make_anatomy(GetParam(), Vec3::Ones());
    const Vec3 spacing(3, 3, 3);
    const RegionImage image = fill_shapes(anatomy, grid_of_box(anatomy, spacing));

    std::array<double, num_pelvis_organs> volume_cm3{};
    for (const auto region : image.voxels) {
        if (region >= first_organ_region) volume_cm3[region - first_organ_region] += 27e-3;
    }

    const std::array<std::array<double, 2>, num_pelvis_organs> allowed{
        {{30, 65}, {25, 75}, {12, 45}, {5, 20}, {5, 20}}};
    for (Index organ = 0; organ < num_pelvis_organs; ++organ) {
        EXPECT_GE(volume_cm3[organ], allowed[organ][0]) << "organ " << organ;
        EXPECT_LE(volume_cm3[organ], allowed[organ][1]) << "organ " << organ;
    }
    for (const OrganShape& organ : anatomy.organs) {
        for (const Vec3& x : surface_points(organ)) {
            const Vec3 from_low = organ.centre + x - anatomy.box_corner;
            EXPECT_GE(from_low.minCoeff(), 20.0);
            EXPECT_GE((anatomy.box_size - from_low).minCoeff(), 20.0);
        }
    }
}

TEST_P(AnatomyOfSeed, KeepsOrgansApartAndTheProstateBetweenBladderAndRectum) {
    const PelvisAnatomy anatomy = make_anatomy(GetParam(), Vec3::Ones());

    std::array<std::vector<Vec3>, num_pelvis_organs> points;
    for (Index a = 0; a < num_pelvis_organs; ++a) points[a] = surface_points(anatomy.organs[a]);
    const auto gap = [&](Index a, Index b) {
        return gap_between(anatomy.organs[a], points[a], anatomy.organs[b], points[b]);
    };
    for (Index a = 0; a < num_pelvis_organs; ++a) {
        for (Index b = a + 1; b < num_pelvis_organs; ++b)
            EXPECT_GE(gap(a, b), 2.0) << a << ' ' << b;
    }
    EXPECT_LE(gap(prostate, bladder), 6.0);
    EXPECT_LE(gap(prostate, rectum), 6.0);
    EXPECT_GT(anatomy.organs[bladder].centre[2], 25);  // superior
    EXPECT_LT(anatomy.organs[bladder].centre[1], 0);   // anterior
    EXPECT_GT(anatomy.organs[rectum].centre[1], 20);   // posterior
    EXPECT_GT(anatomy.organs[bone_left].centre[0], 30);
    EXPECT_LT(anatomy.organs[bone_right].centre[0], -30);
}

TEST_P(AnatomyOfSeed, MovesTheWallsByMillimetresMostOfItAlongTheNormal) {
    const PelvisAnatomy anatomy = make_anatomy(GetParam(), Vec3::Ones());

    for (const WallMotion& motion : make_wall_motions(anatomy, GetParam())) {
        const OrganShape& shape = anatomy.organs[motion.organ()];
        double largest = 0, mean_normal = 0;
        const auto points = surface_points(shape, 500);
        for (const Vec3& x : points) {
            const Vec3 u = motion.displacement(shape.centre + x);
            largest = std::max(largest, u.norm());
            mean_normal += u.dot(shape.normal(shape.centre + x)) / double(points.size());
        }
        EXPECT_LT(largest, 16.0);
        EXPECT_GT(largest, 4.0);
        EXPECT_GT(mean_normal * motion.expansion_mm(), 0);
        EXPECT_NEAR(std::abs(mean_normal), std::abs(motion.expansion_mm()) + 0.5, 2.5);
    }
}

TEST_P(AnatomyOfSeed, ScalesOnlyTheMotionAlongTheWalls) {
    const PelvisAnatomy anatomy = make_anatomy(GetParam(), Vec3::Ones());
    const auto once = make_wall_motions(anatomy, GetParam());
    const auto thrice = make_wall_motions(anatomy, GetParam(), 3);

    for (std::size_t wall = 0; wall < once.size(); ++wall) {
        const OrganShape& shape = anatomy.organs[once[wall].organ()];
        EXPECT_DOUBLE_EQ(thrice[wall].tangential_mm(), 3 * once[wall].tangential_mm());
        double largest = 0;
        for (const Vec3& point : surface_points(shape, 50)) {
            const Vec3 x = shape.centre + point;
            const Vec3 more = thrice[wall].displacement(x) - once[wall].displacement(x);
            EXPECT_NEAR(more.dot(shape.smooth_normal(x)), 0, 1e-9);
            largest = std::max(largest, more.norm());
        }
        EXPECT_GT(largest, 0.2);
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, AnatomyOfSeed, testing::Range(1u, 11u));

TEST(Anatomy, IsTheSameForTheSameSeedAndAnotherForAnother) {
    const auto first = make_anatomy(3, Vec3::Ones()), same = make_anatomy(3, Vec3::Ones());
    const auto other = make_anatomy(4, Vec3::Ones());

    const auto voxels = fill_shapes(first, grid_of_box(first, Vec3(3, 3, 3))).voxels;
    EXPECT_EQ(voxels, fill_shapes(same, grid_of_box(same, Vec3(3, 3, 3))).voxels);
    EXPECT_NE(voxels, fill_shapes(other, grid_of_box(other, Vec3(3, 3, 3))).voxels);
    EXPECT_NE(first.organs[rectum].centre, other.organs[rectum].centre);
}

TEST(Anatomy, HasABoxOfWholeVoxels) {
    for (const Vec3& spacing : {Vec3(1, 1, 1), Vec3(1, 1, 3), Vec3(0.97, 0.97, 2.6)}) {
        const PelvisAnatomy anatomy = make_anatomy(1, spacing);
        const ImageGrid grid = grid_of_box(anatomy, spacing);
        EXPECT_LT((grid.spacing - spacing).norm(), 1e-9);
        EXPECT_LT((grid.origin - 0.5 * spacing - anatomy.box_corner).norm(), 1e-9);
    }
    EXPECT_EQ(make_anatomy(1, Vec3(1, 1, 1)).box_size, make_anatomy(1, Vec3(2, 2, 3)).box_size);
}

TEST(OrganShape, HasTheVolumeAndNormalsOfAnEllipsoidWithoutWarp) {
    OrganShape shape;
    shape.centre = Vec3(5, -3, 2);
    shape.semi_axes = Vec3(10, 8, 6);

    EXPECT_NEAR(shape.value(shape.centre + Vec3(10, 0, 0)), 0, 1e-12);
    EXPECT_NEAR(shape.value(shape.centre + Vec3(0, 0, 7)), 1, 0.2);
    EXPECT_LT((shape.normal(shape.centre + Vec3(0, -8, 0)) + Vec3::UnitY()).norm(), 1e-6);
    for (const Vec3& x : surface_points(shape, 100)) {
        EXPECT_NEAR(x.cwiseQuotient(shape.semi_axes).norm(), 1, 1e-3);
    }
}

TEST(OrganShape, ReportsGapAndOverlap) {
    OrganShape a, b;
    b.centre = Vec3(23.5, 0, 0);
    const auto points = surface_points(a);

    EXPECT_NEAR(gap_between(a, points, b, points), 3.5, 0.2);
    b.centre = Vec3(18, 0, 0);
    EXPECT_NEAR(gap_between(a, points, b, points), -2, 0.3);
}

double gap_of(const PelvisAnatomy& anatomy, PelvisOrgan a, PelvisOrgan b) {
    const auto &first = anatomy.organs[a], &second = anatomy.organs[b];
    return gap_between(first, surface_points(first), second, surface_points(second));
}

TEST(AnatomyFamilies, AreWhatTheirNamesSay) {
    const Vec3 spacing(1, 1, 2);
    const auto of = [&](AnatomyFamily family) { return make_anatomy(5, spacing, family); };
    const Vec3 round = of(AnatomyFamily::round).organs[prostate].semi_axes;
    const Vec3 flat = of(AnatomyFamily::flat).organs[prostate].semi_axes;
    EXPECT_DOUBLE_EQ(round.minCoeff(), round.maxCoeff());
    EXPECT_LT(flat[1], 0.6 * flat[0]);
    EXPECT_LT(std::abs(gap_of(of(AnatomyFamily::touching), prostate, bladder)), 0.6);
    EXPECT_GT(gap_of(of(AnatomyFamily::usual), prostate, bladder), 2.0);

    const PelvisAnatomy cut = of(AnatomyFamily::cut);
    const ImageGrid grid = grid_of_image(cut, spacing);
    const RegionImage image = fill_shapes(cut, grid);
    const auto slice_shows = [&](Index k, PelvisOrgan organ) {
        const auto begin = image.voxels.begin() + grid.size[0] * grid.size[1] * k;
        return std::count(begin, begin + grid.size[0] * grid.size[1], first_organ_region + organ) >
               0;
    };
    EXPECT_EQ(grid.spacing, spacing);
    EXPECT_TRUE(slice_shows(0, rectum));
    EXPECT_TRUE(slice_shows(grid.size[2] - 1, bladder));
    EXPECT_FALSE(slice_shows(0, prostate));
    EXPECT_FALSE(slice_shows(grid.size[2] - 1, prostate));
}

TEST(AnatomyFamilies, AreDrawnAllAndByName) {
    std::set<AnatomyFamily> drawn;
    for (unsigned seed = 1; seed < 60; ++seed) drawn.insert(drawn_for(AnatomyFamily::drawn, seed));
    EXPECT_EQ(drawn, (std::set{AnatomyFamily::round, AnatomyFamily::flat, AnatomyFamily::touching,
                               AnatomyFamily::cut}));
    for (const AnatomyFamily family : drawn) EXPECT_EQ(anatomy_family_of(name_of(family)), family);
    EXPECT_THROW(anatomy_family_of("square"), Error);
}

}  // namespace
}  // namespace palpate

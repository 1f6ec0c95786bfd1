// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/objectives/voxel_terraces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/apps/recover/inverse/linear_row.hpp"

namespace palpate {
namespace {

const Vec3 up(0, 0, 1);

VoxelPlanes thick_slices() {
    VoxelPlanes planes;
    planes.origin = Vec3(3, -2, 5);
    planes.spacing = Vec3(1, 1, 3);
    planes.smoothing_mm = 0.9 * std::cbrt(3.0);
    return planes;
}

LinearRow row_at(const Vec3& place, const Terraces& terraces, const VoxelTerraces& volumes) {
    LinearRow row;
    row.place = place;
    row.terraces = terraces;
    row.range_mm = volumes.range_mm();
    return row;
}

TEST(VoxelTerraces, AreThoseOfASawToothWhereNothingIsSmoothed) {
    // Off by up to half a voxel, evenly: h / sqrt(12); four harmonics hold 0.8654 of its variance.
    const Vec3 deviation = thick_slices().terrace_deviation(up);

    EXPECT_NEAR(deviation[2], 3 * std::sqrt(0.8654 / 12), 1e-3);
    EXPECT_NEAR(deviation[0], 0, 1e-4);
    EXPECT_EQ(thick_slices().terrace_deviation(-up)[2], -deviation[2]);
}

TEST(VoxelTerraces, AreSmoothedAwayAcrossThePlanes) {
    const VoxelPlanes planes = thick_slices();
    double last = planes.terrace_deviation(up)[2];
    for (const double degrees : {15.0, 30.0, 45.0, 60.0, 75.0}) {
        const double angle = degrees * std::acos(-1.0) / 180;
        const double here = planes.terrace_deviation(Vec3(std::sin(angle), 0, std::cos(angle)))[2];
        EXPECT_LT(here, last);
        last = here;
    }
    EXPECT_LT(last, 0.1);
}

TEST(VoxelTerraces, OfTheSamePlanesCancelOverWholeVoxelsAndDoubleOverHalfOnes) {
    VoxelPlanes target = thick_slices();
    target.origin += Vec3(7, 4, 9);  // another box of the same lattice
    const VoxelTerraces both({thick_slices(), target}, 4);
    const double one = thick_slices().terrace_deviation(up)[2];
    const Vec3 x(20.3, 11.8, 31.1);

    EXPECT_NEAR(both.of_distance(x, up, x + Vec3(0.4, 0, 6), up).variance(), 0, 1e-9);
    EXPECT_NEAR(both.of_distance(x, up, x + Vec3(0.4, 0, 1.5), up).variance(), 4 * one * one, 1e-6);
    EXPECT_NEAR(both.of_distance(x, up, x + Vec3(0, 0, 0.75), up).variance(), 2 * one * one, 1e-6);
}

TEST(VoxelTerraces, OfTurnedPlanesAddTheirVariances) {
    VoxelPlanes target = thick_slices();
    target.axes = Eigen::AngleAxisd(0.2, Vec3::UnitX()).toRotationMatrix();
    const VoxelTerraces both({thick_slices(), target}, 4);
    const double expected = thick_slices().terrace_deviation(up).squaredNorm() +
                            target.terrace_deviation(up).squaredNorm();

    for (const double shift : {0.0, 0.8, 1.5, 3.0}) {
        EXPECT_NEAR(both.of_distance(Vec3::Zero(), up, Vec3(0, 0, shift), up).variance(), expected,
                    1e-9);
    }
}

TEST(VoxelTerraces, AreSharedBetweenTheSamePlanesAndOppositeHalfAVoxelFurther) {
    const VoxelTerraces one({thick_slices()}, 4);
    const auto at = [&](const Vec3& place) {
        return row_at(place, one.of_distance(place, up, place, up), one);
    };
    const LinearRow here = at(Vec3::Zero());
    const double variance = noise_variance(here) - here.independent_mm * here.independent_mm;

    EXPECT_NEAR(noise_covariance(here, at(Vec3(5, 0, 0))), variance * std::exp(-5.0 / 12), 1e-3);
    EXPECT_NEAR(noise_covariance(here, at(Vec3(0, 0, 1.5))), -variance * std::exp(-1.5 / 12), 1e-3);
    LinearRow elsewhere = at(Vec3(5, 0, 0));
    elsewhere.surface = 1;
    EXPECT_EQ(noise_covariance(here, elsewhere), 0);
}

}  // namespace
}  // namespace palpate

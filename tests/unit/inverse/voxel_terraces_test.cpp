// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/voxel_terraces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "host/apps/recover/inverse/linear_row.hpp"
#include "host/geometry/surfaces/distance_map.hpp"

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

TEST(VoxelTerraces, OfTheSamePlanesCancelOverWholeVoxelsAsFarAsTheMotionIsKnown) {
    VoxelPlanes target = thick_slices();
    target.origin += Vec3(7, 4, 9);  // another box of the same lattice
    const VoxelTerraces both({thick_slices(), target}, 4);
    const Vec3 x(20.3, 11.8, 31.1);
    const auto variance = [&](const Vec3& normal, double shift) {
        return both.of_distance(x, normal, x + Vec3(0.4, 0, shift), normal).variance();
    };

    double last = 0;
    for (const double degrees : {0.0, 15.0, 35.0}) {
        const double angle = degrees * std::acos(-1.0) / 180;
        const Vec3 normal(0, std::sin(angle), std::cos(angle));
        const double one = std::abs(thick_slices().terrace_deviation(normal)[2]);
        // e^2 + e'^2 - 2 rho e e' cos(2 pi shift / h)
        const double known = std::exp(-4 * std::pow(std::acos(-1.0) * one / 3, 2));
        EXPECT_GT(known, last);
        last = known;
        EXPECT_NEAR(variance(normal, 6), 2 * one * one * (1 - known), 1e-4) << degrees;
        EXPECT_NEAR(variance(normal, 1.5), 2 * one * one * (1 + known), 1e-4) << degrees;
        EXPECT_NEAR(variance(normal, 0.75), 2 * one * one, 1e-4) << degrees;
    }
    EXPECT_GT(last, 0.5);
}

TEST(VoxelTerraces, OfASurfaceAlongThePlanesHaveNearlyTheErrorOfTwo) {
    // It ends where voxels end before and after, so that it seems to have moved by whole voxels.
    const VoxelTerraces both({thick_slices(), thick_slices()}, 4);
    const double one = thick_slices().terrace_deviation(up)[2];
    const Terraces still = both.of_distance(Vec3::Zero(), up, Vec3::Zero(), up);

    EXPECT_GT(still.variance(), 0.9 * 2 * one * one);
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

/// An ellipsoid voxelised exactly, voxels of 1 mm.
struct Ellipsoid {
    Vec3 centre, axes{18, 14, 16};

    Vec3 on_surface(const Vec3& direction) const {
        return centre + direction / direction.cwiseQuotient(axes).norm();
    }
    DistanceMap map() const {
        RegionImage image;
        image.grid.size = {48, 48, 48};
        image.grid.origin = Vec3::Constant(-23.5);
        image.voxels.resize(image.grid.num_voxels());
        for (Index k = 0; k < 48; ++k)
            for (Index j = 0; j < 48; ++j)
                for (Index i = 0; i < 48; ++i) {
                    const Vec3 own = image.grid.to_point(Vec3(i, j, k)) - centre;
                    image.at(i, j, k) = own.cwiseQuotient(axes).norm() < 1 ? 2 : 1;
                }
        return DistanceMap(LabelField(image, 3), 2);
    }
};

/// Distances of points of the true surface over the deviation that voxels are said to leave,
/// where surfaces are found; root mean squares where the surface lies along voxel planes (within 10
/// degrees) and where it does not (more than 20).
TEST(VoxelTerraces, AreAsLargeAsVoxelsMakeThemWhereverTheSurfaceIsFound) {
    constexpr double independent_mm = 0.11;  // [prior] noise_voxels of 1 mm
    VoxelPlanes planes;
    planes.origin = Vec3::Constant(-23.5);
    const VoxelTerraces both({planes, planes}, 4);
    double along = 0, across = 0;
    int num_along = 0, num_across = 0;
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (int pair = 0; pair < 4; ++pair) {
        Ellipsoid before, after;
        before.centre = Vec3(uniform(engine), uniform(engine), uniform(engine));
        const Vec3 moved(uniform(engine), uniform(engine), uniform(engine));
        after.centre = before.centre + moved;
        const DistanceMap reference = before.map(), target = after.map();
        for (int p = 0; p < 400; ++p) {
            const double z = 1 - (2 * p + 1) / 400.0, turn = 2.39996 * p;  // evenly on the sphere
            const double ring = std::sqrt(1 - z * z);
            const Vec3 x = before.on_surface(Vec3(ring * std::cos(turn), ring * std::sin(turn), z));
            Vec3 n, m;
            const double own = reference.value(x, n), other = target.value(x + moved, m);
            const Terraces terraces = both.of_distance(x - own * n, n.normalized(),
                                                       x + moved - other * m, m.normalized());
            const double variance = terraces.variance() + independent_mm * independent_mm;
            const double z2 = std::pow(other - own, 2) / variance;
            const double cosine = n.normalized().cwiseAbs().maxCoeff();
            if (cosine > std::cos(10 * std::acos(-1.0) / 180)) {
                along += z2;
                ++num_along;
            } else if (cosine < std::cos(20 * std::acos(-1.0) / 180)) {
                across += z2;
                ++num_across;
            }
        }
    }
    ASSERT_GT(num_along, 50);
    EXPECT_NEAR(std::sqrt(along / num_along), 0.8, 0.25);
    // The search multiplies the independent part by up to 1.3 (method.md, 4.5).
    EXPECT_NEAR(std::sqrt(across / num_across), 1.05, 0.25);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/distance_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "host/geometry/surfaces/closest_point.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/imaging/voxelised.hpp"
#include "tests/unit/surfaces/analytic_surfaces.hpp"

namespace palpate {
namespace {

using namespace testing;

const Vec3 centre(12.3, -45.6, 78.9);

LabelField sphere_field(double radius, double extent, double voxel,
                        const Mat3& direction = oblique_direction()) {
    return LabelField(
        voxelised_sphere(grid_around(centre, extent, Vec3::Constant(voxel), direction), centre,
                         radius),
        3);
}

struct MapErrors {
    ErrorSummary value, slope;
};

/// Errors of value and |gradient| at distances up to 5 mm from a sphere.
MapErrors sphere_errors(const DistanceMap& map, double radius) {
    std::vector<double> value, slope;
    for (const Vec3& ray : unit_vectors(500)) {
        for (double d : {-4.9, -3.0, -1.1, -0.2, 0.0, 0.7, 1.6, 3.3, 5.0}) {
            Vec3 gradient;
            value.push_back(map.value(centre + (radius + d) * ray, gradient) - d);
            slope.push_back(gradient.norm() - 1);
        }
    }
    const MapErrors e{summary_of(value), summary_of(slope)};
    std::printf("    r %.0f: distance mean %.3f rms %.3f max %.3f mm, slope rms %.3f max %.3f\n",
                radius, e.value.mean, e.value.rms, e.value.max, e.slope.rms, e.slope.max);
    return e;
}

/// A sphere of 15 mm, and another one on its right if that is `with_other`, `gap_mm` from it.
DistanceMap map_beside_a_gap(double gap_mm, bool with_other) {
    constexpr double radius = 15;
    const Vec3 left(0.13, 0.37, 0.29), right = left + Vec3(2 * radius + gap_mm, 0, 0);
    const ImageGrid grid = grid_around(0.5 * (left + right), 84, Vec3::Constant(1.0));
    RegionImage image = voxelised_sphere(grid, left, radius);
    const RegionImage other = voxelised_sphere(grid, right, radius);
    for (std::size_t v = 0; with_other && v < image.voxels.size(); ++v)
        if (other.voxels[v] == first_organ_region) image.voxels[v] = first_organ_region + 1;
    return DistanceMap(LabelField(image, 4), first_organ_region, 6);
}

TEST(DistanceMap, OfAnOrganDoesNotDependOnAnotherBesideIt) {
    for (const double gap_mm : {1.2, 2.0, 2.5, 3.0}) {
        const DistanceMap alone = map_beside_a_gap(gap_mm, false),
                          beside = map_beside_a_gap(gap_mm, true);
        double largest = 0;
        for (const Vec3& ray : unit_vectors(500)) {
            const Vec3 x = Vec3(0.13, 0.37, 0.29) + 15 * ray;
            largest = std::max(largest, std::abs(alone.value(x) - beside.value(x)));
        }
        EXPECT_LT(largest, 0.01) << gap_mm;  // 0.04 against half of what is left of a rival's
    }
}

/// A layer 0 < z < `thickness` between two other regions, at its middle: means over both faces.
double error_of_a_layer(Index thickness) {
    ImageGrid grid = grid_around(Vec3::Zero(), 41, Vec3::Constant(1.0));
    grid.origin.z() += 0.5;  // between planes of voxels
    const LabelField field(voxelised(grid,
                                     [&](const Vec3& x) -> Index {
                                         if (x.z() < 0) return first_organ_region;
                                         return x.z() < double(thickness) ? first_organ_region + 1
                                                                          : background_region;
                                     }),
                           4);
    const DistanceMap map(field, first_organ_region + 1, 6);
    return 0.5 * (map.value(Vec3(0.2, 0.3, 0)) + map.value(Vec3(0.2, 0.3, double(thickness))));
}

TEST(DistanceMap, OfAThinLayerErrsByNoMoreThanTheMeanOfBothFields) {
    for (const Index voxels : {2, 3, 4}) {
        const double error = error_of_a_layer(voxels);
        std::printf("    %d voxels: %.3f mm\n", int(voxels), error);
        EXPECT_LT(std::abs(error), 0.05);  // 0.05 to 0.084 with the layer's own field alone
    }
    EXPECT_LT(std::abs(error_of_a_layer(8)), 0.005);
}

TEST(DistanceMap, OfAFinelyVoxelisedSphereIsItsDistance) {
    for (double radius : {8.0, 15.0}) {
        const MapErrors e =
            sphere_errors(DistanceMap(sphere_field(radius, 2 * radius + 10, 0.4), 2, 6), radius);

        EXPECT_LT(std::abs(e.value.mean), 0.025);
        EXPECT_LT(e.value.rms, 0.065);  // an eighth of the voxel is the noise of voxelisation
        EXPECT_LT(e.slope.rms, 0.03);
    }
}

TEST(DistanceMap, OfMillimetreVoxelsAddsLittleToTheirNoise) {
    const LabelField field = sphere_field(15, 45, 1);
    const DistanceMap map(field, 2);

    // Voxelisation noise: where the zero of the field itself lies along each ray.
    std::vector<double> added;
    for (const Vec3& ray : unit_vectors(500)) {
        double low = 10, high = 20;
        for (int n = 0; n < 40; ++n) {
            const double middle = 0.5 * (low + high);
            (field.interface_value(2, 1, centre + middle * ray) < 0 ? low : high) = middle;
        }
        added.push_back(map.value(centre + low * ray));
    }
    const ErrorSummary noise = summary_of(added);
    const MapErrors total = sphere_errors(map, 15);
    std::printf("    at the zero of the field: mean %.4f rms %.4f max %.4f mm\n", noise.mean,
                noise.rms, noise.max);

    EXPECT_LT(noise.rms, 0.02);
    EXPECT_LT(std::abs(total.value.mean), 0.05);  // of which the position of the voxels: 0.03
    EXPECT_LT(total.value.rms, 0.15);
    EXPECT_LT(total.slope.rms, 0.05);
}

TEST(DistanceMap, OfAnEllipsoidIsItsDistance) {
    const Vec3 axes(20, 12, 9);
    const ImageGrid grid = grid_around(centre, 50, Vec3::Constant(0.5));
    const LabelField field(voxelised(grid,
                                     [&](const Vec3& x) {
                                         const double r = (x - centre).cwiseQuotient(axes).norm();
                                         return r < 1 ? first_organ_region : background_region;
                                     }),
                           3);
    Surface fine = sphere_surface(Vec3::Zero(), 1, 300);
    for (Vec3& v : fine.vertices) v = centre + v.cwiseProduct(axes);
    const ClosestPointQuery query(fine);

    const DistanceMap map(field, 2, 8);

    std::vector<double> value, slope;
    for (const Vec3& ray : unit_vectors(800)) {
        for (double stretch : {0.8, 0.95, 1.0, 1.1, 1.25}) {
            const Vec3 x = centre + stretch * ray.cwiseProduct(axes);
            Vec3 gradient;
            value.push_back(map.value(x, gradient) -
                            std::copysign(query.closest(x).distance_mm, stretch - 1));
            slope.push_back(gradient.norm() - 1);
        }
    }
    std::printf("    distance mean %.3f rms %.3f mm, slope rms %.3f\n", summary_of(value).mean,
                summary_of(value).rms, summary_of(slope).rms);
    EXPECT_LT(std::abs(summary_of(value).mean), 0.02);
    EXPECT_LT(summary_of(value).rms, 0.08);
    EXPECT_LT(summary_of(slope).rms, 0.04);
}

TEST(DistanceMap, GradientIsTheDerivativeOfTheValueInsideAndBeyondTheGrid) {
    const DistanceMap map(sphere_field(10, 40, 1, left_handed_direction()), 2, 8);
    const double step = 0.05;

    for (const Vec3& ray : unit_vectors(60)) {
        for (double r : {7.0, 10.0, 13.0, 30.0, 80.0}) {
            const Vec3 x = centre + r * ray;
            Vec3 gradient;
            map.value(x, gradient);
            for (int a = 0; a < 3; ++a) {
                const Vec3 e = step * Vec3::Unit(a);
                ASSERT_NEAR(gradient[a], (map.value(x + e) - map.value(x - e)) / (2 * step),
                            r < 20 ? 0.01 : 0.03)
                    << "at radius " << r;
            }
        }
    }
}

TEST(DistanceMap, IsPositiveFarOutsideAndNegativeAtTheCentre) {
    const DistanceMap map(sphere_field(10, 40, 1), 2);

    EXPECT_NEAR(map.value(centre), -10, 0.6);
    for (const Vec3& ray : unit_vectors(40)) {
        EXPECT_NEAR(map.value(centre + 25 * ray), 15, 0.4);
        EXPECT_GT(map.value(centre + 200 * ray), 100);
    }
}

TEST(DistanceMap, MovesRigidlyWithoutLoss) {
    const DistanceMap map(sphere_field(10, 40, 1), 2);
    const RigidTransform transform{oblique_direction(), Vec3(5, -60, 7)};

    const DistanceMap moved = map.moved(transform);

    for (const Vec3& ray : unit_vectors(40)) {
        for (double r : {6.0, 11.0, 60.0}) {
            const Vec3 x = centre + r * ray;
            Vec3 before, after;
            const double value = map.value(x, before);
            EXPECT_NEAR(moved.value(transform.apply(x), after), value, 1e-4);
            EXPECT_LT((after - transform.rotation * before).norm(), 1e-4);
        }
    }
}

TEST(DistanceMap, ContinuesAnOrganCutByTheImage) {
    const ImageGrid grid = grid_around(centre, 40, Vec3::Ones());
    const LabelField field(voxelised(grid,
                                     [](const Vec3& x) {
                                         const double r = (x - centre).head<2>().norm();
                                         return r < 8 ? first_organ_region : background_region;
                                     }),
                           3);

    const DistanceMap map(field, 2);

    for (double z : {0.0, 15.0, 20.0, 24.0, 30.0}) {
        EXPECT_NEAR(map.value(centre + Vec3(4, 0, z)), -4, 0.4) << z;
        EXPECT_NEAR(map.value(centre + Vec3(0, -11, -z)), 3, 0.4) << z;
    }
}

TEST(DistanceMap, OfOneOfThreeTouchingOrgansFollowsItsWholeSurface) {
    // Two half balls side by side in a background.
    const ImageGrid grid = grid_around(centre, 50, Vec3::Constant(0.7));
    const LabelField field(voxelised(grid,
                                     [](const Vec3& x) -> Index {
                                         const Vec3 y = x - centre;
                                         if (y.norm() > 15) return background_region;
                                         return y[0] > 0 ? 2 : 3;
                                     }),
                           4);

    const DistanceMap map(field, 2);

    constexpr double half_voxel = 0.35;  // the flat face lies between two layers of voxels
    EXPECT_NEAR(map.value(centre + Vec3(3, 0, 0)), -3, half_voxel);
    EXPECT_NEAR(map.value(centre + Vec3(-3, 0, 0)), 3, half_voxel);
    EXPECT_NEAR(map.value(centre + Vec3(12, 0, 0)), -3, half_voxel);
    EXPECT_NEAR(map.value(centre + Vec3(17, 0, 0)), 2, half_voxel);
    EXPECT_NEAR(map.value(centre + Vec3(-12, 0, 0)), 12, half_voxel);
}

TEST(DistanceMap, RefusesARegionThatIsAbsentOrFillsTheImage) {
    const LabelField field = sphere_field(10, 40, 2);
    EXPECT_THROW(DistanceMap(field, 0), Error);
    EXPECT_THROW(DistanceMap(field, 9), Error);

    ImageGrid grid;
    grid.size = {5, 5, 5};
    EXPECT_THROW(DistanceMap(LabelField({grid, std::vector<std::uint8_t>(125, 1)}, 2), 1), Error);
}

TEST(DistanceMap, SmoothNormalsLeaveOutTheVoxelsAndKeepTheShape) {
    const DistanceMap map(sphere_field(15, 45, 2), 2);
    double rough = 0, smooth = 0;
    for (const Vec3& ray : unit_vectors(200)) {
        const ShapeDistance seen = map.measure(centre + 15 * ray, Vec3::Zero());
        rough += (seen.normal - ray).squaredNorm();
        smooth += (seen.smooth_normal - ray).squaredNorm();
    }
    EXPECT_LT(smooth, 0.5 * rough);
    EXPECT_LT(std::sqrt(smooth / 200), 0.03);
}

TEST(DistanceMap, TakesAboutASecondForAnOrganOfFiveCentimetres) {
    const LabelField field = sphere_field(25, 100, 1);
    const auto start = std::chrono::steady_clock::now();

    const DistanceMap map(field, 2);

    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("    %zu samples in %.2f s\n", map.grid().num_voxels(), seconds);
    EXPECT_LT(seconds, 10);  // wide: the machine may be busy
}

}  // namespace
}  // namespace palpate

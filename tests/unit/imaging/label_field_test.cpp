// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/label_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "solver/base/error.hpp"
#include "tests/unit/imaging/voxelised.hpp"

namespace palpate {
namespace {

using namespace testing;

const Vec3 centre(12.3, -45.6, 78.9);  // away from any voxel corner
constexpr double radius = 15;

/// Radius of the interface between organ and background along a ray, by bisection.
double interface_radius(const LabelField& field, const Vec3& from, const Vec3& ray) {
    double low = 1, high = 30;
    for (int n = 0; n < 40; ++n) {
        const double middle = 0.5 * (low + high);
        const double value =
            field.interface_value(first_organ_region, background_region, from + middle * ray);
        (value < 0 ? low : high) = middle;
    }
    return low;
}

/// Errors of the interface radius over several positions of the sphere relative to the voxels.
struct RadiusErrors {
    double mean = 0;   ///< largest magnitude of the mean error
    double shift = 0;  ///< the same against the sphere of the voxels' volume: the bias of ours
    double rms = 0, max = 0;
};

RadiusErrors radius_errors(const Vec3& spacing, const Mat3& direction, double r) {
    RadiusErrors worst;
    for (const Vec3& offset :
         {Vec3(0.12, -0.35, 0.2), Vec3(0.31, 0.17, -0.4), Vec3(0.4, 0.2, 0.1)}) {
        ImageGrid grid = grid_around(centre, 2 * r + 20, spacing, direction);
        grid.origin += direction * offset.cwiseProduct(spacing);
        const RegionImage image = voxelised_sphere(grid, centre, r);
        const LabelField field(image, 3);
        std::vector<double> errors;
        for (const Vec3& ray : unit_vectors(4000)) {
            errors.push_back(interface_radius(field, centre, ray) - r);
        }
        const auto count = std::count(image.voxels.begin(), image.voxels.end(), first_organ_region);
        const double of_voxels = std::cbrt(0.75 / M_PI * double(count) * grid.voxel_volume()) - r;
        const ErrorSummary s = summary_of(errors);
        worst.mean = std::max(worst.mean, std::abs(s.mean));
        worst.shift = std::max(worst.shift, std::abs(s.mean - of_voxels));
        worst.rms = std::max(worst.rms, s.rms);
        worst.max = std::max(worst.max, s.max);
    }
    std::printf("    spacing %.1f %.1f %.1f, r %.0f: mean %.3f shift %.3f rms %.3f max %.3f mm\n",
                spacing[0], spacing[1], spacing[2], r, worst.mean, worst.shift, worst.rms,
                worst.max);
    return worst;
}

TEST(LabelField, FindsASphereOfOneMillimetreVoxels) {
    const RadiusErrors s = radius_errors(Vec3::Ones(), Mat3::Identity(), radius);

    EXPECT_LT(s.mean, 0.05);
    EXPECT_LT(s.shift, 0.01);
    EXPECT_LT(s.rms, 0.15);
}

TEST(LabelField, FindsASphereOfThickSlices) {
    const RadiusErrors s = radius_errors(Vec3(0.5, 0.5, 3), Mat3::Identity(), radius);

    EXPECT_LT(s.mean, 0.15);
    EXPECT_LT(s.rms, 0.35);
}

TEST(LabelField, DoesNotShrinkASmallSphere) {
    const RadiusErrors s = radius_errors(Vec3::Ones(), Mat3::Identity(), 5);

    EXPECT_LT(s.shift, 0.02);
    EXPECT_LT(s.rms, 0.2);
}

TEST(LabelField, RespectsObliqueAndLeftHandedDirections) {
    for (const Mat3& direction : {oblique_direction(), left_handed_direction()}) {
        const RadiusErrors s = radius_errors(Vec3(1, 1.2, 0.8), direction, radius);

        EXPECT_LT(s.mean, 0.05);
        EXPECT_LT(s.rms, 0.15);
    }
}

TEST(LabelField, GradientIsTheDerivativeOfTheValueInPatientSpace) {
    const ImageGrid grid = grid_around(centre, 60, Vec3(1, 1.5, 2), left_handed_direction());
    const LabelField field(voxelised_sphere(grid, centre, radius), 3);
    const double step = 0.05;

    for (const Vec3& ray : unit_vectors(50)) {
        for (double distance : {5.0, 14.0, 25.0, 60.0}) {  // the last lies beyond the image
            const Vec3 x = centre + distance * ray;
            Vec3 gradient;
            field.value(first_organ_region, x, gradient);
            for (int a = 0; a < 3; ++a) {
                const Vec3 e = step * Vec3::Unit(a);
                const double difference = (field.value(first_organ_region, x + e) -
                                           field.value(first_organ_region, x - e)) /
                                          (2 * step);
                ASSERT_NEAR(gradient[a], difference, 0.02) << "at " << x.transpose();
            }
        }
    }
}

TEST(LabelField, AnOrganCutByTheImageRunsStraightOn) {
    // A cylinder along z through the whole image.
    const ImageGrid grid = grid_around(centre, 40, Vec3::Ones());
    const LabelField field(voxelised(grid,
                                     [](const Vec3& x) {
                                         const double r = (x - centre).head<2>().norm();
                                         return r < 8 ? first_organ_region : background_region;
                                     }),
                           3);

    EXPECT_TRUE(field.cut_by_image(first_organ_region));
    for (double z : {0.0, 19.0, 21.0, 24.0, 35.0, 100.0}) {
        EXPECT_EQ(field.region_at(centre + Vec3(6.5, 0, z)), first_organ_region) << z;
        EXPECT_EQ(field.region_at(centre + Vec3(9.5, 0, z)), background_region) << z;
        EXPECT_EQ(field.region_at(centre + Vec3(0, 9.5, -z)), background_region) << z;
    }
}

TEST(LabelField, KeepsItsSignsFarFromTheOrgan) {
    const ImageGrid grid = grid_around(centre, 120, Vec3(2, 2, 2));
    const LabelField field(voxelised_sphere(grid, centre, 6), 3);

    for (double distance : {10.0, 25.0, 50.0, 300.0}) {
        const Vec3 x = centre + Vec3(0, distance, 0);
        EXPECT_NEAR(field.value(first_organ_region, x), distance - 6,
                    distance < 60 ? 1.0 : 250.0);  // held beyond the image
        EXPECT_EQ(field.region_at(x), background_region);
    }
}

TEST(LabelField, SeparatesThreeRegionsAtOneVoxelAccuracy) {
    auto region = [](const Vec3& x) {
        const Vec3 y = x - centre;
        if (y.norm() > 14) return background_region;
        return y[0] + 0.3 * y[1] > 0 ? first_organ_region : first_organ_region + 1;
    };
    const LabelField field(voxelised(grid_around(centre, 50, Vec3::Ones()), region), 5);

    int wrong = 0, checked = 0;
    for (const Vec3& ray : unit_vectors(500)) {
        for (double r : {4.0, 12.5, 15.5}) {
            const Vec3 x = centre + r * ray;
            if (std::abs(ray[0] + 0.3 * ray[1]) * r < 0.8) continue;
            wrong += field.region_at(x) != region(x);
            ++checked;
        }
    }

    EXPECT_EQ(wrong, 0) << "of " << checked;
    EXPECT_FALSE(field.has_region(0));
    EXPECT_FALSE(field.has_region(4));
    EXPECT_GT(field.value(4, centre), 1e3);
}

TEST(LabelField, AcceptsARegionThatFillsTheImage) {
    ImageGrid grid;
    grid.size = {5, 1, 3};
    const LabelField field({grid, std::vector<std::uint8_t>(15, 1)}, 2);

    EXPECT_EQ(field.region_at(Vec3(2, 0, 1)), 1);
    EXPECT_LT(field.value(1, Vec3(2, 0, 1)), 0);
}

TEST(LabelField, InsideBoxCountsHalfAVoxelRoundTheCentres) {
    ImageGrid grid;
    grid.size = {5, 5, 5};
    const LabelField field({grid, std::vector<std::uint8_t>(125, 1)}, 2);

    EXPECT_TRUE(field.inside_box(Vec3(-0.49, 2, 4.49)));
    EXPECT_FALSE(field.inside_box(Vec3(-0.51, 2, 2)));
    EXPECT_FALSE(field.inside_box(Vec3(2, 2, 4.51)));
}

TEST(LabelField, RefusesAnEmptyImageAndUnknownRegions) {
    ImageGrid grid;
    grid.size = {2, 2, 2};

    EXPECT_THROW(LabelField({grid, {}}, 2), Error);
    EXPECT_THROW(LabelField({grid, std::vector<std::uint8_t>(8, 7)}, 3), Error);
}

}  // namespace
}  // namespace palpate

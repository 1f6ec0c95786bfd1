// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/warp_volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "solver/base/error.hpp"
#include "tests/unit/warping/oblique_scene.hpp"

namespace palpate {
namespace {

using namespace testing;

LabelImage asymmetric_labels(const ImageGrid& grid) {
    LabelImage image{grid, std::vector<std::uint16_t>(grid.num_voxels(), 0)};
    for (Index k = 3; k < 6; ++k)
        for (Index j = 4; j < 10; ++j)
            for (Index i = 5; i < 8; ++i) image.at(i, j, k) = 1;
    for (Index j = 4; j < 6; ++j)
        for (Index i = 8; i < 12; ++i) image.at(i, j, 4) = 2;
    image.at(5, 9, 6) = 3;
    return image;
}

TEST(WarpLabels, MovesAnAsymmetricImageAlongTheDisplacementInPatientAxes) {
    ImageGrid grid;
    grid.size = {20, 18, 12};
    grid.origin = Vec3(10, -30, 5);
    grid.spacing = Vec3(1, 1, 2);
    grid.direction = Vec3(-1, 1, 1).asDiagonal();  // i runs to the patient's right
    const LabelImage labels = asymmetric_labels(grid);
    const Image<Vec3> u{grid, std::vector<Vec3>(grid.num_voxels(), Vec3(-3, 2, 4))};

    const LabelImage warped =
        warp_labels(labels, PointMap{u, true}, grid, Interpolation::nearest).image;

    for (Index k = 0; k < 12; ++k)
        for (Index j = 0; j < 18; ++j)
            for (Index i = 0; i < 20; ++i) {
                const bool known = i >= 3 && j >= 2 && k >= 2;
                const int expected = known ? labels.at(i - 3, j - 2, k - 2) : 0;
                ASSERT_EQ(warped.at(i, j, k), expected) << i << ' ' << j << ' ' << k;
            }
}

TEST(WarpLabels, InvertsASteepSmoothField) {
    ImageGrid grid;
    grid.size = {80, 10, 10};
    LabelImage labels{grid, std::vector<std::uint16_t>(grid.num_voxels(), 0)};
    Image<Vec3> u{grid, std::vector<Vec3>(grid.num_voxels())};
    // du/dx reaches +1.2: plain fixed-point iteration diverges, x + u(x) is still one to one.
    const auto shift = [](double x) { return 12.0 + 12.0 * std::tanh((x - 30.0) / 10.0); };
    for (Index k = 0; k < 10; ++k)
        for (Index j = 0; j < 10; ++j)
            for (Index i = 0; i < 80; ++i) {
                labels.at(i, j, k) = i >= 30 ? 1 : 0;
                u.at(i, j, k) = Vec3(shift(i), 0, 0);
            }

    const LabelImage warped =
        warp_labels(labels, PointMap{u, true}, grid, Interpolation::nearest).image;

    const double edge = 29.5 + shift(29.5);
    for (Index i = 0; i < 80; ++i) {
        if (std::abs(i - edge) < 0.5) continue;
        EXPECT_EQ(warped.at(i, 5, 5), i > edge ? 1 : 0) << i;
    }
}

/// A smooth image, brightest away from every symmetry of its grid.
float brightness(const Vec3& x) {
    return static_cast<float>(100 + 40 * std::sin(0.11 * x.x()) + 30 * std::cos(0.09 * x.y()) +
                              2 * (x.z() - 130));
}

Image<float> picture(const ImageGrid& grid) {
    Image<float> image{grid, {}};
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i)
                image.voxels.push_back(brightness(grid.to_point(Vec3(i, j, k))));
    return image;
}

/// Largest difference from `brightness` at the points that an inner voxel shows.
double largest_error(Interpolation interpolation) {
    const ImageGrid grid = oblique_grid();
    const PointMap back{sampled(grid, smooth_displacement)};
    ImageGrid fine = grid;
    fine.spacing /= 2;
    fine.size = {60, 50, 30};
    const auto warped = warp_image(picture(grid), back, fine, interpolation);
    double largest = 0;
    for (Index k = 8; k < 22; ++k)
        for (Index j = 12; j < 38; ++j)
            for (Index i = 14; i < 46; ++i) {
                const Vec3 x = back.moved(fine.to_point(Vec3(i, j, k))).point;
                largest =
                    std::max<double>(largest, std::abs(warped.image.at(i, j, k) - brightness(x)));
            }
    return largest;
}

TEST(WarpImage, FetchesEachVoxelFromWhereTheMapPoints) {
    EXPECT_LT(largest_error(Interpolation::linear), 0.6);  // of 150; curvature x spacing^2 / 8
    EXPECT_LT(largest_error(Interpolation::cubic), 0.06);
    EXPECT_GT(largest_error(Interpolation::nearest), 1);
}

TEST(WarpImage, KeepsAnImageThatDoesNotMove) {
    const Image<float> image = picture(oblique_grid({9, 8, 7}));
    const PointMap still{{image.grid, std::vector<Vec3>(image.voxels.size(), Vec3::Zero())}};

    for (const auto how : {Interpolation::nearest, Interpolation::linear, Interpolation::cubic}) {
        const auto warped = warp_image(image, still, image.grid, how);
        for (std::size_t v = 0; v < image.voxels.size(); ++v) {
            ASSERT_NEAR(warped.image.voxels[v], image.voxels[v], 1e-3);
        }
        EXPECT_EQ(warped.outside.field + warped.outside.image, 0u);
    }
}

TEST(WarpImage, FillsWhatLiesOutsideAndCountsIt) {
    const Image<float> image = picture(oblique_grid({9, 8, 7}));
    const Vec3 three_columns = image.grid.direction.col(0) * 3 * image.grid.spacing[0];
    const PointMap shift{{image.grid, std::vector<Vec3>(image.voxels.size(), three_columns)}};

    const auto warped = warp_image(image, shift, image.grid, Interpolation::linear, -5);

    EXPECT_EQ(warped.outside.image, 3u * 8 * 7);
    EXPECT_EQ(warped.outside.field, 0u);
    EXPECT_EQ(warped.image.at(8, 2, 2), -5);
    EXPECT_NEAR(warped.image.at(2, 2, 2), image.at(5, 2, 2), 1e-3);
}

TEST(WarpLabels, SmoothGivesSubVoxelSurfacesAndKeepsTheirNumbers) {
    const ImageGrid grid = oblique_grid({30, 26, 14});
    LabelImage labels{grid, std::vector<std::uint16_t>(grid.num_voxels(), 0)};
    const auto label_at = [](const Vec3& index) {
        return (index - Vec3(12, 13, 7)).cwiseProduct(Vec3(1.3, 1.7, 2.9)).norm() < 9 ? 1200 : 7;
    };
    for (Index k = 0; k < 14; ++k)
        for (Index j = 0; j < 26; ++j)
            for (Index i = 0; i < 30; ++i)
                labels.at(i, j, k) = static_cast<std::uint16_t>(label_at(Vec3(i, j, k)));
    const Vec3 half(0.5, 0.5, 0.5);
    const Vec3 shift = grid.direction * half.cwiseProduct(grid.spacing);
    const PointMap back{{grid, std::vector<Vec3>(grid.num_voxels(), shift)}};

    const auto wrong = [&](Interpolation how) {
        const LabelImage warped = warp_labels(labels, back, grid, how).image;
        int count = 0;
        for (Index k = 1; k < 12; ++k)
            for (Index j = 1; j < 24; ++j)
                for (Index i = 1; i < 28; ++i)
                    count += warped.at(i, j, k) != label_at(Vec3(i, j, k) + half);
        return count;
    };

    EXPECT_LT(wrong(Interpolation::smooth), 0.25 * wrong(Interpolation::nearest));
}

TEST(WarpVolume, RefusesInterpolationsThatMakeNoSense) {
    const Image<float> image = picture(oblique_grid({4, 4, 4}));
    const LabelImage labels{image.grid, std::vector<std::uint16_t>(64, 1)};
    const PointMap still{{image.grid, std::vector<Vec3>(64, Vec3::Zero())}};

    EXPECT_THROW(warp_image(image, still, image.grid, Interpolation::smooth), Error);
    EXPECT_THROW(warp_labels(labels, still, image.grid, Interpolation::linear), Error);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/contour_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Mean of f(x) f(x + shift) over many fields.
double covariance(ContourStyle style, double length_mm, const Vec3& shift) {
    constexpr int fields = 4000;
    double sum = 0;
    for (int seed = 0; seed < fields; ++seed) {
        const RandomField field(style, length_mm, 17 + std::uint64_t(seed));
        sum += field.value(Vec3(3, -2, 5)) * field.value(Vec3(3, -2, 5) + shift);
    }
    return sum / fields;
}

TEST(ContourError, FieldsHaveTheKernelThatTheyAreNamedAfter) {
    const Vec3 shift = 5 * Vec3(1, 2, -2) / 3;  // 5 mm
    const double q = std::sqrt(3.0) * 5 / 7;
    EXPECT_NEAR(covariance(ContourStyle::matern32, 7, Vec3::Zero()), 1, 0.08);
    EXPECT_NEAR(covariance(ContourStyle::matern32, 7, shift), (1 + q) * std::exp(-q), 0.06);
    EXPECT_NEAR(covariance(ContourStyle::exponential, 7, shift), std::exp(-5.0 / 7), 0.06);
    EXPECT_NEAR(covariance(ContourStyle::squared, 7, shift), std::exp(-25.0 / 98), 0.06);
}

/// A ball of 15 mm (region 2) in 1 mm voxels.
RegionImage ball() {
    ImageGrid grid;
    grid.size = {41, 41, 41};
    RegionImage image{grid, std::vector<std::uint8_t>(grid.num_voxels(), background_region)};
    for (Index k = 0; k < 41; ++k)
        for (Index j = 0; j < 41; ++j)
            for (Index i = 0; i < 41; ++i)
                if ((Vec3(i, j, k) - Vec3(20, 20, 20)).norm() < 15) image.at(i, j, k) = 2;
    return image;
}

std::size_t differing(const RegionImage& a, const RegionImage& b) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < a.voxels.size(); ++v) count += a.voxels[v] != b.voxels[v];
    return count;
}

TEST(ContourError, MovesSurfacesByItsStandardDeviation) {
    const RegionImage image = ball();
    const LabelField truth(image, 3);
    const RegionImage exact = drawn_regions(truth, image.grid, {}, 1);
    for (const char* style : {"exponential", "matern32", "squared", "slices"}) {
        // Mean of |N(0, 0.6)| is 0.48 mm, on 4 pi 15^2 mm^2.
        const auto options = contour_error_of(std::string(style) + ":0.6:5");
        double volume = 0;
        for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8})
            volume += double(differing(drawn_regions(truth, image.grid, options, seed), exact)) / 8;
        const double expected = 0.48 * 4 * 3.14159 * 15 * 15;
        // In plane: over a ball the mean of the normal's part there is pi / 4.
        const double part = style == std::string("slices") ? 0.785 : 1.0;
        EXPECT_NEAR(volume / expected, part, 0.1) << style;
    }
}

TEST(ContourError, IsTheSameForTheSameSeed) {
    const RegionImage image = ball();
    const LabelField truth(image, 3);
    const auto options = contour_error_of("matern32:0.5:7");
    const RegionImage one = drawn_regions(truth, image.grid, options, 5);
    EXPECT_EQ(differing(one, drawn_regions(truth, image.grid, options, 5)), 0u);
    EXPECT_GT(differing(one, drawn_regions(truth, image.grid, options, 6)), 100u);
}

TEST(ContourError, IsReadAndWritten) {
    EXPECT_EQ(contour_error_of("exact").style, ContourStyle::exact);
    const auto options = contour_error_of("slices:0.25:9");
    EXPECT_EQ(options.style, ContourStyle::slices);
    EXPECT_EQ(options.sd_mm, 0.25);
    EXPECT_EQ(options.length_mm, 9);
    EXPECT_EQ(to_text(options), "slices:0.25:9");
    for (const char* wrong : {"", "rough:0.5:7", "matern32", "matern32:0.5", "matern32:9:7",
                              "matern32:0.5:0", "matern32:0.5:7mm", "matern32:nan:7", "exact:1:7"})
        EXPECT_THROW(contour_error_of(wrong), Error) << wrong;
}

}  // namespace
}  // namespace palpate

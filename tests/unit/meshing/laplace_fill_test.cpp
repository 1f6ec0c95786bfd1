// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/laplace_fill.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

/// Cycles stop when nothing changes by more; the error left is some fifteen times as large.
constexpr double tolerance = 1e-4, allowed = 20 * tolerance;

Image<Vec3> empty_image(const std::array<Index, 3>& size, const Vec3& spacing) {
    Image<Vec3> image;
    image.grid.size = size;
    image.grid.spacing = spacing;
    image.voxels.assign(image.grid.num_voxels(), Vec3(777, 777, 777));
    return image;
}

/// Harmonic, and quadratic: the seven-point stencil has no error on them.
Vec3 harmonic(const Vec3& x) {
    return {x[0] * x[0] - x[1] * x[1] + 3 * x[0], x[0] * x[1] - 2 * x[2],
            2 * x[2] * x[2] - x[0] * x[0] - x[1] * x[1]};
}

TEST(LaplaceFill, FindsHarmonicFunctionsFromTheirValuesOnTheBorder) {
    // Sizes that do not halve evenly, spacings that differ.
    Image<Vec3> image = empty_image({19, 14, 11}, {0.5, 0.75, 1.1});
    std::vector<std::uint8_t> unknown(image.voxels.size(), 0);
    const auto [nx, ny, nz] = image.grid.size;
    for (Index k = 0; k < nz; ++k)
        for (Index j = 0; j < ny; ++j)
            for (Index i = 0; i < nx; ++i) {
                const bool inside =
                    i > 0 && j > 0 && k > 0 && i < nx - 1 && j < ny - 1 && k < nz - 1;
                unknown[image.grid.offset(i, j, k)] = inside;
                if (!inside) image.at(i, j, k) = harmonic(image.grid.to_point(Vec3(i, j, k)));
            }

    laplace_fill(image, unknown, tolerance);

    double worst = 0;
    for (Index k = 0; k < nz; ++k)
        for (Index j = 0; j < ny; ++j)
            for (Index i = 0; i < nx; ++i)
                worst = std::max(worst,
                                 (image.at(i, j, k) - harmonic(image.grid.to_point(Vec3(i, j, k))))
                                     .cwiseAbs()
                                     .maxCoeff());
    EXPECT_LT(worst, allowed);
}

TEST(LaplaceFill, NothingFlowsThroughTheBorderOfTheImage) {
    // Between two known planes the answer is linear, with all side walls left open.
    Image<Vec3> image = empty_image({9, 5, 4}, {1, 2, 1.5});
    std::vector<std::uint8_t> unknown(image.voxels.size(), 1);
    for (Index k = 0; k < 4; ++k)
        for (Index j = 0; j < 5; ++j)
            for (const Index i : {0, 8}) {
                unknown[image.grid.offset(i, j, k)] = 0;
                image.at(i, j, k) = i == 0 ? Vec3(0, 5, -3) : Vec3(8, 5, 1);
            }

    laplace_fill(image, unknown, tolerance);

    for (Index k = 0; k < 4; ++k)
        for (Index j = 0; j < 5; ++j)
            for (Index i = 0; i < 9; ++i)
                EXPECT_LT((image.at(i, j, k) - Vec3(i, 5, -3 + 0.5 * i)).norm(), allowed);
}

TEST(LaplaceFill, StaysBetweenWhatIsKnownAndLeavesThatAlone) {
    Image<Vec3> image = empty_image({12, 12, 12}, Vec3::Ones());
    std::vector<std::uint8_t> unknown(image.voxels.size(), 1);
    const std::size_t low = image.grid.offset(2, 3, 4), high = image.grid.offset(9, 8, 7);
    unknown[low] = unknown[high] = 0;
    image.voxels[low] = Vec3(-1, -1, -1);
    image.voxels[high] = Vec3(1, 2, 3);

    laplace_fill(image, unknown, tolerance);

    EXPECT_EQ(image.voxels[low], Vec3(-1, -1, -1));
    EXPECT_EQ(image.voxels[high], Vec3(1, 2, 3));
    for (const Vec3& value : image.voxels) {
        EXPECT_TRUE((value.array() >= -1 - allowed).all() &&
                    (value.array() <= Eigen::Array3d(1, 2, 3) + allowed).all())
            << value.transpose();
    }
}

TEST(LaplaceFill, KnowsNothingWithoutKnownVoxels) {
    Image<Vec3> image = empty_image({5, 4, 3}, Vec3::Ones());

    laplace_fill(image, std::vector<std::uint8_t>(image.voxels.size(), 1), tolerance);

    for (const Vec3& value : image.voxels) EXPECT_EQ(value, Vec3(0, 0, 0));
}

}  // namespace
}  // namespace palpate

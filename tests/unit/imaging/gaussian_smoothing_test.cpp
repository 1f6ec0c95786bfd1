// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/gaussian_smoothing.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

TEST(SmoothGaussian, SpreadsAPointByItsVarianceAndKeepsItsSum) {
    const std::array<Index, 3> size{31, 33, 35};
    std::vector<float> volume(31 * 33 * 35, 0.f);
    volume[15 + 31 * (16 + 33 * 17)] = 1.f;

    smooth_gaussian(size, 2.0, volume);

    double sum = 0;
    Vec3 squares = Vec3::Zero();
    for (Index k = 0; k < 35; ++k)
        for (Index j = 0; j < 33; ++j)
            for (Index i = 0; i < 31; ++i) {
                const double value = volume[i + 31 * (j + 33 * k)];
                sum += value;
                squares += value * Vec3(i - 15, j - 16, k - 17).cwiseAbs2();
            }
    EXPECT_NEAR(sum, 1, 1e-5);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(squares[axis], 4, 0.15);
}

TEST(SmoothGaussian, LeavesWhatIsConstantAndWhatHasNoWidth) {
    const std::array<Index, 3> size{5, 4, 6};
    std::vector<float> volume(5 * 4 * 6, 7.f);
    smooth_gaussian(size, 3.0, volume);
    for (const float value : volume) EXPECT_NEAR(value, 7, 1e-5);
    volume[17] = 1.f;
    const auto before = volume;
    smooth_gaussian(size, 0.0, volume);
    EXPECT_EQ(volume, before);
}

}  // namespace
}  // namespace palpate

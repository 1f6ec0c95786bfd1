// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/signed_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace palpate {
namespace {

constexpr std::array<Index, 3> size{13, 19, 7};  // no multiple of a block of lines
const Vec3 spacing(0.5, 0.8, 3.0);

std::vector<std::uint8_t> random_mask(unsigned seed, double share) {
    std::mt19937 random(seed);
    std::bernoulli_distribution inside(share);
    std::vector<std::uint8_t> mask(size[0] * size[1] * size[2]);
    for (auto& voxel : mask) voxel = inside(random);
    return mask;
}

/// Distance of the centre of voxel `p` to the nearest box of a voxel with the other value.
double brute_force(const std::vector<std::uint8_t>& mask, Index p) {
    double nearest = std::numeric_limits<double>::infinity();
    auto voxel = [&](Index n) {
        return std::array<Index, 3>{n % size[0], n / size[0] % size[1], n / size[0] / size[1]};
    };
    for (Index q = 0; q < Index(mask.size()); ++q) {
        if (mask[q] == mask[p]) continue;
        double sum = 0;
        for (int a = 0; a < 3; ++a) {
            const double gap = std::max(0.0, std::abs(voxel(p)[a] - voxel(q)[a]) - 0.5);
            sum += std::pow(gap * spacing[a], 2);
        }
        nearest = std::min(nearest, sum);
    }
    return (mask[p] ? -1 : 1) * std::sqrt(nearest);
}

TEST(SignedDistance, MatchesBruteForceOnAnisotropicVoxels) {
    for (double share : {0.02, 0.5, 0.97}) {
        const auto mask = random_mask(7, share);

        const std::vector<float> distance = signed_distance(size, spacing, mask);

        for (Index p = 0; p < Index(mask.size()); ++p) {
            ASSERT_NEAR(distance[p], brute_force(mask, p), 1e-4) << "voxel " << p;
        }
    }
}

TEST(SignedDistance, ChangesOnlyItsSignForTheComplement) {
    auto mask = random_mask(3, 0.2);
    const auto distance = signed_distance(size, spacing, mask);

    for (auto& voxel : mask) voxel = !voxel;
    const auto opposite = signed_distance(size, spacing, mask);

    for (std::size_t p = 0; p < mask.size(); ++p) ASSERT_EQ(distance[p], -opposite[p]);
}

TEST(SignedDistance, IsFiniteForAnEmptyAndAFullMask) {
    const std::vector<std::uint8_t> empty(size[0] * size[1] * size[2], 0), full(empty.size(), 1);

    EXPECT_EQ(signed_distance(size, spacing, empty)[5], distance_to_nothing_mm);
    EXPECT_EQ(signed_distance(size, spacing, full)[5], -distance_to_nothing_mm);
}

TEST(Smoothing, LeavesQuadraticFunctionsUnchanged) {
    const std::array<Index, 3> box{40, 40, 40};
    const Vec3 h(0.5, 1.0, 3.0);
    auto quadratic = [&](Index i, Index j, Index k) {
        const double x = i * h[0] - 8, y = j * h[1] - 15, z = k * h[2] - 50;
        return float(0.1 * x * x - 0.2 * y * y + 0.01 * z * z + 0.1 * x - 3);
    };
    std::vector<float> volume;
    for (Index k = 0; k < 40; ++k)
        for (Index j = 0; j < 40; ++j)
            for (Index i = 0; i < 40; ++i) volume.push_back(quadratic(i, j, k));

    smooth_without_shrinking(box, h, 0.9, volume);

    EXPECT_NEAR(volume[20 + 40 * (18 + 40 * 21)], quadratic(20, 18, 21), 1e-3);
}

TEST(Smoothing, RemovesAStaircaseOfVoxelSize) {
    const std::array<Index, 3> box{48, 48, 8};
    std::vector<float> volume;
    for (Index k = 0; k < 8; ++k)
        for (Index j = 0; j < 48; ++j)
            for (Index i = 0; i < 48; ++i) volume.push_back((i + j + k) % 2 ? 1.f : -1.f);

    smooth_without_shrinking(box, Vec3::Ones(), 0.9, volume);

    EXPECT_LT(std::abs(volume[24 + 48 * (24 + 48 * 4)]), 0.05);
}

}  // namespace
}  // namespace palpate

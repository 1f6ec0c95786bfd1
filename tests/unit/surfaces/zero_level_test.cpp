// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/zero_level.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/unit/imaging/voxelised.hpp"

namespace palpate {
namespace {

using namespace testing;

const Vec3 centre(3, -4, 5);

double not_quite_linear(const Vec3& x) { return (x - centre).squaredNorm() / 16 - 4; }

Surface sphere_of_radius_eight(const Mat3& direction) {
    const ImageGrid grid = grid_around(centre, 22, Vec3(1, 1, 1), direction);
    std::vector<float> samples;
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i)
                samples.push_back(float(not_quite_linear(grid.to_point(Vec3(i, j, k)))));
    return zero_level(grid, samples, not_quite_linear);
}

TEST(ZeroLevel, IsAClosedSurfacePointingOutward) {
    for (const Mat3& direction : {oblique_direction(), left_handed_direction()}) {
        const Surface s = sphere_of_radius_eight(direction);

        std::map<std::pair<Index, Index>, int> balance;
        for (const Triangle& t : s.triangles) {
            for (int e = 0; e < 3; ++e) {
                const Index a = t[e], b = t[(e + 1) % 3];
                balance[std::minmax(a, b)] += a < b ? 1 : -1;
            }
        }
        for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0);
        EXPECT_NEAR(enclosed_volume(s), 4.0 / 3 * M_PI * 512, 15);
    }
}

TEST(ZeroLevel, PutsItsVerticesOntoTheZeroOfTheFunction) {
    for (const Vec3& v : sphere_of_radius_eight(Mat3::Identity()).vertices) {
        ASSERT_NEAR((v - centre).norm(), 8, 0.005);
    }
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/zones.hpp"

#include <gtest/gtest.h>

#include "host/apps/phantom/anatomy.hpp"

namespace palpate {
namespace {

constexpr Index whole = first_organ_region + prostate, part = 40;

struct Voxels {
    double count = 0;
    Vec3 mean = Vec3::Zero();
};

Voxels voxels_of(const RegionImage& image, Index region) {
    Voxels voxels;
    for (Index k = 0; k < image.grid.size[2]; ++k)
        for (Index j = 0; j < image.grid.size[1]; ++j)
            for (Index i = 0; i < image.grid.size[0]; ++i) {
                if (image.at(i, j, k) != region) continue;
                voxels.mean += image.grid.to_point(Vec3(i, j, k));
                ++voxels.count;
            }
    voxels.mean /= voxels.count;
    return voxels;
}

TEST(Zones, TransitionZoneFillsAThirdOfTheProstateInFront) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        const PelvisAnatomy anatomy = make_anatomy(seed, Vec3::Constant(2));
        RegionImage image = fill_shapes(anatomy, grid_of_box(anatomy, Vec3::Constant(2)));
        const double before = voxels_of(image, whole).count;

        mark_zone(image, make_transition_zone(anatomy.organs[prostate], seed), whole, part);

        const Voxels transition = voxels_of(image, part), peripheral = voxels_of(image, whole);
        EXPECT_EQ(transition.count + peripheral.count, before);
        EXPECT_GT(transition.count, 0.2 * before) << seed;
        EXPECT_LT(transition.count, 0.5 * before) << seed;
        EXPECT_LT(transition.mean[1], peripheral.mean[1] - 8) << seed;  // y points backwards
    }
}

TEST(Zones, VaryWithTheSeedAndAreTheSameForOne) {
    const OrganShape prostate_shape = make_anatomy(1, Vec3::Ones()).organs[prostate];
    const Vec3 x = prostate_shape.centre;

    EXPECT_EQ(make_transition_zone(prostate_shape, 3).value(x),
              make_transition_zone(prostate_shape, 3).value(x));
    EXPECT_NE(make_transition_zone(prostate_shape, 3).value(x),
              make_transition_zone(prostate_shape, 4).value(x));
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/volumes.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr Index organ = first_organ_region;

ImageGrid grid_of(Index size) {
    ImageGrid grid;
    grid.size = {size, size, size};
    return grid;
}

/// A block of the organ in background, not symmetric in any axis.
RegionImage block() {
    RegionImage image{grid_of(24), {}};
    image.voxels.assign(image.grid.num_voxels(), background_region);
    for (Index k = 6; k < 18; ++k) {
        for (Index j = 5; j < 14; ++j) {
            for (Index i = 4; i < 12; ++i) image.at(i, j, k) = organ;
        }
    }
    return image;
}

double first_column(const RegionImage& image) {
    for (Index i = 0; i < image.grid.size[0]; ++i) {
        if (image.at(i, 9, 12) == organ) return i;
    }
    return -1;
}

TEST(CarryRegions, WithoutDisplacementGivesTheReferenceBack) {
    const RegionImage reference = block();
    const LabelField field(reference, organ + 1);

    const auto carried = carry_regions(field, RigidTransform{}, reference.grid);

    EXPECT_GT(dice(carried, reference, organ), 0.97);
}

TEST(CarryRegions, FetchesTheOrganFromWhereTheTargetsDisplacementPoints) {
    const RegionImage reference = block();
    const LabelField field(reference, organ + 1);
    Image<Vec3> way_back{reference.grid, {}};
    way_back.voxels.assign(reference.grid.num_voxels(), Vec3(-3, 0, 0));

    const auto carried = carry_regions(field, way_back);

    EXPECT_EQ(first_column(carried), first_column(reference) + 3);
}

TEST(CarryRegions, WithoutDisplacementFollowsTheAlignment) {
    const RegionImage reference = block();
    const LabelField field(reference, organ + 1);
    const RigidTransform transform{Mat3::Identity(), Vec3(5, 0, 0)};

    const auto carried = carry_regions(field, transform, reference.grid);

    EXPECT_EQ(first_column(carried), first_column(reference) + 5);
}

TEST(Dice, IsOneForEqualAndZeroForDisjointRegions) {
    const RegionImage one = block();
    RegionImage none = one;
    for (auto& voxel : none.voxels) voxel = background_region;

    EXPECT_DOUBLE_EQ(dice(one, one, organ), 1.0);
    EXPECT_DOUBLE_EQ(dice(one, none, organ), 0.0);
}

TEST(WithAlignment, GivesTheWholeWayToTheTarget) {
    Image<Vec3> field{grid_of(3), {}};
    field.voxels.assign(27, Vec3(1, 2, 3));
    const RigidTransform transform{Mat3::Identity(), Vec3(10, 0, 0)};

    const auto total = with_alignment(field, transform);

    EXPECT_LT((total.at(2, 1, 0) - Vec3(11, 2, 3)).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate

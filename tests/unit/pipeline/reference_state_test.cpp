// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/reference_state.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/geometry/surfaces/distance_map.hpp"
#include "tests/fixtures/bone_and_gland.hpp"

namespace palpate {
namespace {

constexpr Index bone = first_organ_region;

Segmentation volume() {
    Segmentation segmentation;
    segmentation.name = "reference";
    segmentation.labels.grid.size = {56, 48, 48};
    for (Index k = 0; k < 48; ++k)
        for (Index j = 0; j < 48; ++j)
            for (Index i = 0; i < 56; ++i) {
                const Vec3 x(i, j, k);
                const bool is_bone =
                    Vec3(x - Vec3(18, 24, 24)).cwiseQuotient(Vec3(12, 9, 8)).norm() < 1;
                const bool is_gland = (x - Vec3(42, 24, 24)).norm() < 8;
                segmentation.labels.voxels.push_back(is_bone ? 1 : is_gland ? 2 : 0);
            }
    return segmentation;
}

TEST(ReferenceState, IsAlignedByPointsOnTheContourHoweverLongTheEdgesAre) {
    RecoverOptions options;
    options.settings = fixtures::bone_and_gland();
    for (const Index num_nodes : {300, 3000}) {
        options.mesher.num_nodes = num_nodes;

        const ReferenceState reference =
            make_reference(make_state(volume(), options.settings), options, {});

        ASSERT_EQ(reference.fixed_points.size(), 1u);
        ASSERT_GT(reference.fixed_points[0].size(), 10u);
        const DistanceMap contour(reference.state.field, bone);
        for (const Vec3& point : reference.fixed_points[0])
            EXPECT_LT(std::abs(contour.value(point)), 0.01);
        // What they are made of lies off it where edges are long.
        double farthest = 0;
        for (const Vec3& corner : surface_of_region(reference.surface, bone, false).vertices)
            farthest = std::max(farthest, std::abs(contour.value(corner)));
        EXPECT_GT(farthest, 0.02);
    }
}

}  // namespace
}  // namespace palpate

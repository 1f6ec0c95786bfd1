// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/label_volumes.hpp"

#include <gtest/gtest.h>

#include "host/apps/recover/report/static_slices.hpp"
#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

/// A small result with one organ voxel at index (1, 2, 3) of a grid with the given directions.
RecoveryResult one_voxel(const Mat3& direction) {
    RecoveryResult r;
    r.regions.push_back(
        {2, "dot", 7, Role::tissue, false, true, 0.4, 50, {40, 60}, 0.1, Verdict::recovered, ""});
    r.reference_labels.grid.size = {30, 31, 32};
    r.reference_labels.grid.spacing = Vec3(1, 2, 4);
    r.reference_labels.grid.direction = direction;
    r.reference_labels.grid.origin = Vec3(100, -50, 7);
    r.reference_labels.voxels.assign(r.reference_labels.grid.num_voxels(), 0);
    r.reference_labels.at(1, 2, 3) = 7;
    r.target_labels_aligned = r.warped_labels = r.reference_labels;
    return r;
}

Vec3 point_of(const LabelVolumes& v, Index i, Index j, Index k) {
    return v.origin + v.axes * Vec3(i, j, k).cwiseProduct(v.spacing);
}

/// Finds the only voxel that is set; fails if there are others.
std::array<Index, 3> only_voxel(const LabelVolumes& v) {
    std::array<Index, 3> found{-1, -1, -1};
    int count = 0;
    for (Index k = 0; k < v.size[2]; ++k)
        for (Index j = 0; j < v.size[1]; ++j)
            for (Index i = 0; i < v.size[0]; ++i)
                if (v.reference[v.offset(i, j, k)]) found = {i, j, k}, ++count;
    EXPECT_EQ(count, 1);
    return found;
}

TEST(LabelVolumes, KeepThePlaceOfAVoxelOnTurnedAndMirroredGrids) {
    Mat3 turned, mirrored = Vec3(-1, -1, 1).asDiagonal();
    turned << 0, 0, 1, -1, 0, 0, 0, 1, 0;
    for (const Mat3& direction : {Mat3(Mat3::Identity()), turned, mirrored}) {
        const RecoveryResult r = one_voxel(direction);

        const LabelVolumes v = label_volumes(r);
        const auto at = only_voxel(v);

        EXPECT_LT(
            (point_of(v, at[0], at[1], at[2]) - r.reference_labels.grid.to_point(Vec3(1, 2, 3)))
                .norm(),
            1e-12);
        EXPECT_TRUE(v.axes.isApprox(Mat3(Mat3::Identity())));
        EXPECT_EQ(v.centre, at);
        EXPECT_LT(v.size[0] * v.size[1] * v.size[2], 30 * 31 * 32);
    }
}

TEST(LabelVolumes, ThinOutLargeVolumesButKeepTheirPlace) {
    const RecoveryResult r = synthetic_result();

    const LabelVolumes whole = label_volumes(r), thin = label_volumes(r, 50'000);

    EXPECT_LE(thin.reference.size(), 50'000u);
    EXPECT_GT(thin.spacing[0], whole.spacing[0]);
    const Vec3 a = point_of(whole, whole.centre[0], whole.centre[1], whole.centre[2]);
    const Vec3 b = point_of(thin, thin.centre[0], thin.centre[1], thin.centre[2]);
    EXPECT_LT((a - b).norm(), thin.spacing.norm());
}

TEST(LabelVolumes, StartInTheUnknownOrgans) {
    const LabelVolumes v = label_volumes(synthetic_result());

    EXPECT_GT(v.reference[v.offset(v.centre[0], v.centre[1], v.centre[2])], 0);
    EXPECT_LE(v.reference[v.offset(v.centre[0], v.centre[1], v.centre[2])], 2);
    EXPECT_NEAR(v.tilt_deg, 0.1 * 180 / 3.14159265, 1e-6);
}

TEST(LabelVolumes, ATargetOnAnotherGridIsNotShownInTheWrongPlace) {
    RecoveryResult r = synthetic_result();
    r.target_labels_aligned.grid.size[0] -= 1;

    const LabelVolumes v = label_volumes(r);

    for (std::uint8_t voxel : v.target) ASSERT_EQ(voxel, 0);
}

TEST(LabelVolumes, AreEmptyWithoutOrganVoxels) {
    RecoveryResult r = one_voxel(Mat3::Identity());
    r.reference_labels.at(1, 2, 3) = 0;
    r.target_labels_aligned = r.warped_labels = r.reference_labels;

    EXPECT_TRUE(label_volumes(r).empty());
}

TEST(StaticSlices, DrawTheOutlineInTrueProportions) {
    const RecoveryResult r = one_voxel(Mat3::Identity());

    const std::string svg = static_slice_svg(r, label_volumes(r), SliceView::coronal);

    // Cropped at the image edge below and 8 mm beyond the voxel above: 10 x 6 voxels of 1 x 4 mm.
    EXPECT_NE(svg.find("viewBox='0 0 10.00 20.00'"), std::string::npos) << svg;
    EXPECT_NE(svg.find("scale(1 4)"), std::string::npos) << svg;
    EXPECT_NE(svg.find("M1 2h1v1h-1z"), std::string::npos) << svg;
}

}  // namespace
}  // namespace palpate

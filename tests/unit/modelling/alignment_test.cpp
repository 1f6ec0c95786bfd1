// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "solver/base/error.hpp"
#include "tests/fixtures/bone_and_gland.hpp"

namespace palpate {
namespace {

constexpr Index bone = first_organ_region, gland = first_organ_region + 1;

/// A bone with three unlike axes and a gland beside it, moved by a rigid motion.
RegionImage image_of(const RigidTransform& motion) {
    RegionImage image;
    image.grid.size = {64, 56, 48};
    image.grid.origin = Vec3(-32, -28, -24);
    image.voxels.assign(image.grid.num_voxels(), background_region);
    const RigidTransform back = motion.inverse();
    for (Index k = 0; k < 48; ++k)
        for (Index j = 0; j < 56; ++j)
            for (Index i = 0; i < 64; ++i) {
                const Vec3 x = back.apply(image.grid.to_point(Vec3(i, j, k)));
                if (Vec3(x - Vec3(-6, 0, 0)).cwiseQuotient(Vec3(14, 10, 8)).norm() < 1)
                    image.at(i, j, k) = bone;
                else if ((x - Vec3(14, 3, -2)).norm() < 5)
                    image.at(i, j, k) = gland;
            }
    return image;
}

RigidTransform turned(double degrees, const Vec3& axis, const Vec3& shift) {
    return {Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix(), shift};
}

/// Points of the bone's surface in the reference, on its zero level.
std::vector<Vec3> bone_points(const DistanceMap& map) {
    std::vector<Vec3> points;
    for (int a = 1; a < 12; ++a)
        for (int b = 0; b < 24; ++b) {
            const double theta = M_PI * a / 12, phi = M_PI * b / 12;
            const Vec3 unit(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                            std::cos(theta));
            Vec3 x = Vec3(-6, 0, 0) + unit.cwiseProduct(Vec3(14, 10, 8));
            for (int step = 0; step < 5; ++step) {
                Vec3 gradient;
                const double value = map.value(x, gradient);
                x -= value * gradient / gradient.squaredNorm();
            }
            points.push_back(x);
        }
    return points;
}

struct Case {
    RegionImage reference = image_of({});
    DistanceMap reference_map{LabelField(reference, 4), bone};
    std::vector<Vec3> points = bone_points(reference_map);
};

TEST(Alignment, OfSurfacesFindsTheMotionOfTheBone) {
    const Case c;
    const RigidTransform motion = turned(7, {1, 2, -1}, {2.5, -1.5, 1});
    const DistanceMap target(LabelField(image_of(motion), 4), bone);

    const AlignmentResult found = align_surfaces({c.points}, {target}, {});

    EXPECT_EQ(found.method, "fixed");
    // A tenth of a voxel is what its voxels leave of a surface.
    EXPECT_LT(found.mean_distance_mm, 0.15);
    for (const Vec3& x : c.points)
        EXPECT_LT((found.reference_to_target.apply(x) - motion.apply(x)).norm(), 0.3);
    EXPECT_EQ(found.points.size(), c.points.size());
}

TEST(Alignment, OfASurfaceMovedRigidlyInMemoryIsExact) {
    const Case c;
    const RigidTransform motion = turned(4, {0, 1, 3}, {1, 2, -1});

    const AlignmentResult found = align_surfaces({c.points}, {c.reference_map.moved(motion)}, {});

    const Mat3 left = found.reference_to_target.rotation.transpose() * motion.rotation;
    EXPECT_LT((left - Mat3::Identity()).norm(), 1e-3);
    EXPECT_LT((found.reference_to_target.translation - motion.translation).norm(), 0.02);
    EXPECT_LT(found.mean_distance_mm, 0.01);
}

TEST(Alignment, RefusesSurfacesThatDoNotMeet) {
    const Case c;
    RegionImage other = image_of({});
    for (auto& voxel : other.voxels)  // the gland takes the name of the bone
        voxel = voxel == gland ? bone : background_region;
    const DistanceMap target(LabelField(other, 4), bone);

    try {
        align_surfaces({c.points}, {target}, {});
        FAIL() << "a bone of 14 mm was laid on a ball of 5 mm";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
    }
}

TEST(Alignment, OfCentroidsTakesTheOrgansThatMayMove) {
    const Vec3 shift(3, -2, 4);  // whole voxels: exact
    RegionImage reference = image_of({}), target = reference;
    std::fill(target.voxels.begin(), target.voxels.end(), background_region);
    for (Index k = 0; k < 44; ++k)
        for (Index j = 2; j < 56; ++j)
            for (Index i = 0; i < 61; ++i)
                if (reference.at(i, j, k) == gland)
                    target.at(i + 3, j - 2, k + 4) = static_cast<std::uint8_t>(gland);
    for (std::size_t v = 0; v < target.voxels.size(); ++v)  // the bone stays: it must not count
        if (reference.voxels[v] == bone && target.voxels[v] != gland) target.voxels[v] = bone;

    const RigidTransform found = align_centroids(reference, target, fixtures::bone_and_gland());

    EXPECT_EQ(found.rotation, Mat3(Mat3::Identity()));
    EXPECT_LT((found.translation - shift).norm(), 1e-9);
}

TEST(Alignment, MethodsHaveNames) {
    EXPECT_EQ(align_method_of("auto"), AlignMethod::automatic);
    EXPECT_EQ(align_method_of("fixed"), AlignMethod::fixed);
    EXPECT_EQ(align_method_of("centroid"), AlignMethod::centroid);
    EXPECT_EQ(align_method_of("none"), AlignMethod::none);
    try {
        align_method_of("bones");
        FAIL() << "there is no such method";
    } catch (const Error& error) {
        for (const char* word : {"bones", "auto", "fixed", "centroid", "none"})
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word;
    }
}

}  // namespace
}  // namespace palpate

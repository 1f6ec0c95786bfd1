// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/surface_agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/geometry/surfaces/surface_shape.hpp"
#include "tests/unit/surfaces/analytic_surfaces.hpp"

namespace palpate {
namespace {

Surface ball(double radius_mm) { return testing::sphere_surface(Vec3::Zero(), radius_mm, 24); }

/// One sphere of 10 mm whose target is a surface; nothing else is known of the recovery.
struct OneSphere {
    Recovered found;
    TargetState target;
    SurfaceResult result;

    explicit OneSphere(const Surface& shown) {
        const Surface sphere = ball(10);
        ObservedSurface observed;
        observed.region = 2;
        observed.surface = sphere;
        for (Index n = 0; n < static_cast<Index>(sphere.vertices.size()); ++n)
            observed.node_of.push_back(n);
        found.recovery.surfaces.push_back(observed);
        found.displacement = Eigen::VectorXd::Zero(3 * static_cast<Index>(sphere.vertices.size()));
        found.target.push_back(std::make_shared<SurfaceShape>(shown));
        result.target_kind = "surface";
        result.target = shown;
    }
    void grow_by(double mm) {
        const auto& vertices = found.recovery.surfaces[0].surface.vertices;
        for (std::size_t v = 0; v < vertices.size(); ++v)
            found.displacement.segment<3>(3 * static_cast<Index>(v)) =
                mm * vertices[v].normalized();
    }
    SurfaceResult measured() {
        measure_agreement(found, 0, target, result);
        return result;
    }
};

TEST(SurfaceAgreement, ConcentricSpheresAreApartByTheDifferenceOfTheirRadii) {
    OneSphere spheres(ball(12));
    spheres.grow_by(1.5);
    const SurfaceResult result = spheres.measured();
    for (const double before : {result.mean_distance_mm_before, result.max_distance_mm_before,
                                result.hausdorff95_mm_before})
        EXPECT_NEAR(before, 2, 0.15);
    for (const double after :
         {result.mean_distance_mm_after, result.max_distance_mm_after, result.hausdorff95_mm_after})
        EXPECT_NEAR(after, 0.5, 0.15);
    EXPECT_DOUBLE_EQ(result.seen_share, 1);
}

TEST(SurfaceAgreement, TheHausdorffDistanceSeesWhatTheTargetHasAndTheOrganDoesNot) {
    Surface bumpy = ball(10);
    for (Vec3& vertex : bumpy.vertices)  // a finger over a tenth of the sphere
        if (vertex.z() > 8) vertex.z() += 15;
    const SurfaceResult result = OneSphere(bumpy).measured();
    // From the organ, the finger's root is near everywhere; from its tip, the organ is far.
    EXPECT_LT(result.max_distance_mm_before, 10);
    EXPECT_GT(result.hausdorff95_mm_before, 12);
}

TEST(SurfaceAgreement, AFewFarPointsDoNotCountIntoThe95thPercentile) {
    Surface spiky = ball(10);
    spiky.vertices[0] *= 3;
    const SurfaceResult result = OneSphere(spiky).measured();
    EXPECT_LT(result.hausdorff95_mm_before, 1);
}

TEST(SurfaceAgreement, WhatLiesBeyondTheRimOfAnOpenSurfaceIsLeftOut) {
    OneSphere spheres(ball(10));
    Surface& open = spheres.found.recovery.surfaces[0].surface;
    std::erase_if(open.triangles, [&](const Triangle& t) {
        return open.vertices[t[0]].z() > 3 || open.vertices[t[1]].z() > 3;
    });
    EXPECT_LT(spheres.measured().hausdorff95_mm_after, 0.5);
}

TEST(SurfaceAgreement, WithoutATargetNothingIsKnown) {
    OneSphere spheres(ball(10));
    spheres.found.target[0] = nullptr;
    spheres.result.target = {};
    spheres.result.target_kind = "none";
    const SurfaceResult result = spheres.measured();
    EXPECT_TRUE(std::isnan(result.hausdorff95_mm_after));
    EXPECT_TRUE(std::isnan(result.mean_distance_mm_after));
    EXPECT_TRUE(std::isnan(result.max_distance_mm_after));
    EXPECT_EQ(result.seen_share, 0);
}

}  // namespace
}  // namespace palpate

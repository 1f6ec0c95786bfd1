// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/partial_target.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "host/apps/recover/pipeline/observed_target.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double radius = 12;
const Vec3 centre(30, -20, 10);  // of the organ, mm LPS

/// A ball of 2 mm voxels.
Segmentation ball() {
    Segmentation segmentation{{}, "ball"};
    LabelImage& labels = segmentation.labels;
    labels.grid.size = {20, 20, 20};
    labels.grid.spacing = Vec3::Constant(2);
    labels.grid.origin = centre - Vec3::Constant(19);
    labels.voxels.assign(labels.grid.num_voxels(), 0);
    for (Index k = 0; k < 20; ++k) {
        for (Index j = 0; j < 20; ++j) {
            for (Index i = 0; i < 20; ++i) {
                const Vec3 x = labels.grid.to_point(Vec3(i, j, k)) - centre;
                if (x.norm() < radius) labels.at(i, j, k) = 1;
                if (i == 0) labels.at(i, j, k) = 2;
            }
        }
    }
    return segmentation;
}

/// Points of the upper half of the organ's surface, moved.
std::vector<Vec3> upper_half(const Vec3& shift) {
    std::vector<Vec3> points;
    for (int r = 1; r < 20; ++r) {
        for (int s = 0; s < 40; ++s) {
            const double polar = 0.5 * std::numbers::pi * r / 20, angle = std::numbers::pi * s / 20;
            points.push_back(centre + shift +
                             radius * Vec3(std::sin(polar) * std::cos(angle),
                                           std::sin(polar) * std::sin(angle), std::cos(polar)));
        }
    }
    return points;
}

class PartialTargets : public testing::Test {
protected:
    PartialTargets() { options.settings = settings(); }
    static PartialTarget points(const std::string& organ, std::vector<Vec3> list) {
        return {{{organ, "cloud.csv", std::move(list)}}, 0.5};
    }
    void expect_refused(ErrorCode code, const std::string& words, const PartialTarget& target) {
        try {
            check_partial_target(target, options);
            place_target(target, reference, options);
            FAIL() << "taken: " << words;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    }
    RecoverOptions options;
    ReferenceState reference{make_state(ball(), settings()), 0, {}, {}};

private:
    static Settings settings() {
        Settings settings;
        settings.background = BackgroundSettings{};
        settings.organs = {{"ball", 1, Role::tissue, false, {}, 0.4},
                           {"wall", 2, Role::fixed, true, {}, 0.4}};
        return settings;
    }
};

TEST_F(PartialTargets, AreMeasuredOutwardWhereTheyWereSeen) {
    const PartialTarget target = points("ball", upper_half(Vec3(0, 0, 3)));

    const TargetState state = place_target(target, reference, options);
    const auto shapes = target_shapes(state, options.settings);

    ASSERT_EQ(shapes.size(), 1u);
    const Vec3 up(0, 0, 1);
    const ShapeDistance top = shapes[0]->measure(centre + radius * up, up);
    EXPECT_TRUE(top.is_seen);
    EXPECT_NEAR(top.mm, -3, 0.3);
    EXPECT_FALSE(shapes[0]->measure(centre - radius * up, -up).is_seen);
    EXPECT_EQ(state.shown[0].kind, "points");
    EXPECT_EQ(state.alignment.method, "none");
    EXPECT_TRUE(in_field_of_view(state, Vec3(1e4, 0, 0)));
}

TEST_F(PartialTargets, AddTheirNoiseToHalfThatOfTwoLabelVolumes) {
    const TargetState state =
        place_target(points("ball", upper_half(Vec3::Zero())), reference, options);

    const auto noise = observation_options(options.settings, reference.state, state);

    const double voxels = options.settings.prior.noise_voxels * 2.0;
    EXPECT_NEAR(noise.noise_mm, std::sqrt(0.5 * voxels * voxels + 0.25), 1e-12);
    EXPECT_EQ(noise.voxels.size(), 1u);
}

TEST_F(PartialTargets, NeedAnOrganThatMoves) {
    const auto cloud = upper_half(Vec3::Zero());
    expect_refused(ErrorCode::invalid_argument, "no organ 'bal'", points("bal", cloud));
    expect_refused(ErrorCode::invalid_argument, "'wall' is fixed", points("wall", cloud));
    PartialTarget twice = points("ball", cloud);
    twice.organs.push_back({"ball", "surface.ply", Surface{}});
    expect_refused(ErrorCode::invalid_argument, "two targets", twice);
    expect_refused(ErrorCode::invalid_argument, "label volume", {});
}

TEST_F(PartialTargets, RefuseWhatNeedsLabels) {
    const PartialTarget target = points("ball", upper_half(Vec3::Zero()));
    options.align = AlignMethod::fixed;
    expect_refused(ErrorCode::invalid_argument, "--align none", target);
    options.align = AlignMethod::none;
    options.method = SearchMethod::nested_lbfgs;
    expect_refused(ErrorCode::invalid_argument, "--method map", target);
}

TEST_F(PartialTargets, OfAnotherUnitPlaceOrFrameAreRefusedWithTheLikelyReason) {
    auto metres = upper_half(Vec3::Zero()), flipped = metres;
    for (Vec3& x : metres) x /= 1000;
    for (Vec3& x : flipped) x.head<2>() *= -1;
    expect_refused(ErrorCode::input_unusable, "metres", points("ball", metres));
    expect_refused(ErrorCode::input_unusable, "--target-frame", points("ball", flipped));
    expect_refused(ErrorCode::input_unusable, "mm away",
                   points("ball", upper_half(Vec3(0, 200, 0))));
}

}  // namespace
}  // namespace palpate

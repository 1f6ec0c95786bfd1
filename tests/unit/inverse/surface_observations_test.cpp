// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/surface_observations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/unit/inverse/flat_organ.hpp"

namespace palpate {
namespace {

/// The plane z = 0, as if voxels had shown it.
struct VoxelPlane : TargetShape {
    ShapeDistance measure(const Vec3& point, const Vec3&) const override {
        return {point.z(), Vec3::UnitZ(), true, Vec3::UnitZ()};
    }
    bool is_of_voxels() const override { return true; }
};

constexpr Index side = 7;  // nodes, 3 mm apart
constexpr Index driven_node = 2 * side + 2, held_node = 4 * side + 4, middle = 3 * side + 3;

RecoveryModel sheet() {
    RecoveryModel recovery = flat_organ(side, 3.0);
    for (const Index node : recovery.surfaces[0].node_of) {
        if (node == driven_node) recovery.driven.push_back(node);
        if (node != driven_node && node != held_node) recovery.observed.push_back(node);
    }
    return recovery;
}

/// z grows linearly along the sheet.
double lift_mm(const Vec3& x) { return 0.1 + 0.03 * x.x() - 0.02 * x.y(); }

struct Sheet {
    RecoveryModel recovery = sheet();
    std::vector<std::uint8_t> seen = std::vector<std::uint8_t>(side * side, 1);
    ObservationOptions options;

    SurfaceObservations observations() const {
        const auto plane = std::make_shared<VoxelPlane>();
        return {recovery, {{plane}, {plane}}, seen, options};
    }
    ObservedState lifted(const SurfaceObservations& observations,
                         double (*lift_of)(const Vec3&) = lift_mm) const {
        const auto lift = [&](const std::vector<Index>& nodes) {
            Eigen::VectorXd u = Eigen::VectorXd::Zero(3 * static_cast<Index>(nodes.size()));
            for (std::size_t k = 0; k < nodes.size(); ++k)
                u[3 * static_cast<Index>(k) + 2] = lift_of(recovery.model.mesh.nodes[nodes[k]]);
            return u;
        };
        return observations.evaluate(lift(recovery.driven), lift(recovery.observed));
    }
};

Index row_of(const SurfaceObservations& observations, Index node) {
    for (Index k = 0; k < observations.num_rows(); ++k)
        if (observations.rows()[k].node == node) return k;
    return -1;
}

TEST(SurfaceObservations, TheMeanOfAPatchIsWhatItsNodeMovesByWhereMotionIsLinear) {
    const Sheet sheet;
    const auto observations = sheet.observations();
    const ObservedState state = sheet.lifted(observations);

    EXPECT_EQ(row_of(observations, held_node), -1);
    EXPECT_TRUE(observations.rows()[row_of(observations, driven_node)].on_driven);
    int with_patch = 0;
    for (Index k = 0; k < observations.num_rows(); ++k) {
        const Observation& row = observations.rows()[k];
        const auto& ends = row.patch.ends;
        if (std::find(ends.begin(), ends.end(), held_node) != ends.end()) continue;
        EXPECT_NEAR(state.residual_mm[k], lift_mm(row.place), 1e-12) << row.node;
        with_patch += !ends.empty();
    }
    EXPECT_GT(with_patch, 15);
}

TEST(SurfaceObservations, AnEdgeToAHeldNodeMovesHalfAsFarInItsMiddle) {
    const Sheet sheet;
    const auto observations = sheet.observations();
    const Index k = row_of(observations, held_node - 1);
    const Observation& row = observations.rows()[k];
    const auto end = std::find(row.patch.ends.begin(), row.patch.ends.end(), held_node);
    ASSERT_NE(end, row.patch.ends.end());
    const double weight = row.patch.weights[1 + (end - row.patch.ends.begin())];

    EXPECT_NEAR(
        sheet.lifted(observations).residual_mm[k],
        lift_mm(row.place) - 0.5 * weight * lift_mm(sheet.recovery.model.mesh.nodes[held_node]),
        1e-12);
}

TEST(SurfaceObservations, TheMiddlesOfAPatchFollowMotionThatBends) {
    const auto bend_mm = [](const Vec3& x) { return 0.02 * x.x() * x.x() - 0.01 * x.x() * x.y(); };
    Sheet sheet;
    sheet.recovery.observed.push_back(held_node);
    const auto observations = sheet.observations();
    const ObservedState state = sheet.lifted(observations, bend_mm);

    int bent = 0;
    for (Index k = 0; k < observations.num_rows(); ++k) {
        const Observation& row = observations.rows()[k];
        const Index i = row.node % side, j = row.node / side;
        if (i < 2 || j < 2 || i > side - 3 || j > side - 3) continue;
        double mean = 0;
        for (std::size_t p = 0; p < row.patch.offsets.size(); ++p)
            mean += row.patch.weights[p] * bend_mm(row.place + row.patch.offsets[p]);
        EXPECT_NEAR(state.residual_mm[k], mean, 1e-12) << row.node;
        bent += std::abs(mean - bend_mm(row.place)) > 0.01;
    }
    EXPECT_EQ(bent, 9);
}

TEST(SurfaceObservations, BesideWhatIsOutsideTheImageANodeStandsForItselfAlone) {
    Sheet sheet;
    const auto whole = sheet.observations();
    sheet.seen[middle + 1] = 0;
    const auto part = sheet.observations();
    const Observation &with = whole.rows()[row_of(whole, middle)],
                      &without = part.rows()[row_of(part, middle)];

    EXPECT_EQ(with.patch.ends.size(), 6u);
    EXPECT_TRUE(without.patch.ends.empty());
    EXPECT_NEAR(without.independent_mm, 2 * with.independent_mm, 1e-12);
    EXPECT_EQ(with.num_measured, 4);
    EXPECT_EQ(without.num_measured, 1);
}

TEST(SurfaceObservations, NodesAreMeasuredAloneWhereThatIsAskedFor) {
    Sheet sheet;
    sheet.options.over_patches = false;
    const auto observations = sheet.observations();
    for (const Observation& row : observations.rows()) EXPECT_TRUE(row.patch.ends.empty());
}

}  // namespace
}  // namespace palpate

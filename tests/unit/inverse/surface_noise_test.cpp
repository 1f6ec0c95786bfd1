// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/surface_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/unit/inverse/flat_organ.hpp"

namespace palpate {
namespace {

/// The plane z = 0, on which each point finds what it is told.
struct Plane : TargetShape {
    ShapeDistance measure(const Vec3& point, const Vec3&) const override {
        return {point.z(), Vec3(0.1, 0, 1), true, Vec3::UnitZ()};
    }
};

constexpr Index side = 15;  // nodes, 2 mm apart

RecoveryModel observed_organ() {
    RecoveryModel recovery = flat_organ(side, 2.0);
    recovery.observed = recovery.surfaces[0].node_of;
    return recovery;
}

struct Fixture {
    RecoveryModel recovery = observed_organ();
    std::shared_ptr<const TargetShape> plane = std::make_shared<Plane>();
    SurfaceObservations observations{recovery,
                                     {{plane}, {plane}},
                                     std::vector<std::uint8_t>(side* side, 1),
                                     {0.2, 0.1, {}, 4.0, {}}};
    SurfaceNoise noise{observations};

    /// Of a node's row as it was made.
    double independent_mm(Index position) const {
        return observations.rows()[position].independent_mm;
    }
    double mean_variance() const {
        double sum = 0;
        for (const Observation& row : observations.rows())
            sum += row.independent_mm * row.independent_mm / double(side * side);
        return sum;
    }

    /// Nodes that are off by `mm` within `radius_mm` of the middle.
    ObservedState bump(double mm, double radius_mm) const {
        ObservedState state =
            observations.evaluate(Eigen::VectorXd(), Eigen::VectorXd::Zero(3 * side * side));
        for (const Index node : off(radius_mm)) state.residual_mm[node] = mm;
        return state;
    }
    std::set<Index> off(double radius_mm) const {
        const Vec3 middle = recovery.model.mesh.nodes[side * side / 2];
        std::set<Index> nodes;
        for (Index n = 0; n < side * side; ++n)
            if ((recovery.model.mesh.nodes[n] - middle).norm() <= radius_mm) nodes.insert(n);
        return nodes;
    }
};

TEST(SurfaceNoise, CountsOneNodeThatDiffersFromItsNeighboursLessAndNoOther) {
    Fixture f;
    f.noise.set_level({1, 0.5});
    const ObservedState state = f.bump(4, 0.1);
    const auto rows = f.noise.count(state)->linear_rows(state);
    for (const LinearRow& row : rows) {
        if (row.position == side * side / 2) {
            EXPECT_GT(row.independent_mm, 2.5 * f.independent_mm(row.position));
            EXPECT_LT(row.weight, 0.5);
        } else {
            EXPECT_LT(row.independent_mm, 1.5 * f.independent_mm(row.position));
        }
    }
}

TEST(SurfaceNoise, CountsASmoothBumpAsOneOutlier) {
    Fixture f;
    f.noise.set_level({1, 0.5});
    const ObservedState small = f.bump(0.5, 8), large = f.bump(5, 8);
    const double first = f.noise.count(small)->misfit(small.residual_mm);
    const auto counted = f.noise.count(large);
    // Ten times as far off: far less than a hundred times the misfit.
    EXPECT_LT(counted->misfit(large.residual_mm), 40 * first);
    Index more = 0;
    for (const LinearRow& row : counted->linear_rows(large)) more += row.contour_mm > 0.6;
    EXPECT_GT(more, static_cast<Index>(f.off(4).size()));
}

TEST(SurfaceNoise, RemembersNothingOfEarlierOutliersAndLevels) {
    Fixture used, fresh;
    used.noise.set_level({1, 0.3});
    for (const double mm : {0.2, 4.0}) used.noise.count(used.bump(mm, 3));
    for (const double level : {0.5, 0.8}) {
        used.noise.set_level({1, level});
        fresh.noise = SurfaceNoise(fresh.observations);
        fresh.noise.set_level({1, level});
        const ObservedState state = used.bump(0.4, 8);
        EXPECT_DOUBLE_EQ(used.noise.count(state)->misfit(state.residual_mm),
                         fresh.noise.count(state)->misfit(state.residual_mm));
    }
}

TEST(SurfaceNoise, GrowsAnOutliersVarianceByHowFarItIsFromWhereItsNeighboursSay) {
    Fixture f;
    f.noise.set_level({1, 0.5});
    const ObservedState state = f.bump(4, 0.1);
    const std::vector<LinearRow> rows = f.noise.count(state)->linear_rows(state);
    const Index n = static_cast<Index>(rows.size());
    Eigen::MatrixXd covariance(n, n);
    Eigen::VectorXd residual(n);
    Index outlier = -1;
    for (Index j = 0; j < n; ++j) {
        residual[j] = rows[j].residual_mm;
        if (rows[j].position == side * side / 2) outlier = j;
        for (Index i = 0; i < n; ++i)
            covariance(i, j) =
                i == j ? noise_variance(rows[i]) : noise_covariance(rows[i], rows[j]);
    }
    ASSERT_GE(outlier, 0);
    // Without its own inflation it would be |z| deviations off; then it is sqrt(3 |z|).
    const double plain = std::pow(f.independent_mm(side * side / 2), 2),
                 own = std::pow(rows[outlier].independent_mm, 2);
    const Eigen::MatrixXd precision = covariance.inverse();
    const double conditional = 1 / precision(outlier, outlier);
    const double off = (precision * residual)[outlier] * conditional;
    const double before = conditional - (own - plain);
    const double z = std::abs(off) / std::sqrt(before);
    EXPECT_GT(z, 3);
    EXPECT_NEAR(conditional, before * z / 3, 0.02 * conditional);
}

TEST(SurfaceNoise, WithoutASharedPartIsHubersLoss) {
    Fixture f;
    f.noise.set_level({1, 0});
    const ObservedState state = f.bump(4, 0.1);
    const double sd = f.noise.count(state)->linear_rows(f.bump(0, 0.1))[0].independent_mm;
    ASSERT_GT(sd, 0);
    const Index middle = side * side / 2;
    const double z = 4 / f.independent_mm(middle);
    EXPECT_NEAR(f.noise.count(state)->misfit(state.residual_mm), 3 * (z - 1.5), 1e-6);
    EXPECT_EQ(f.off(0.1), std::set<Index>{middle});
}

TEST(SurfaceNoise, FollowsTheTargetsSlopesOnlyAsFarAsContoursAreRight) {
    Fixture f;
    const ObservedState state = f.bump(0, 0.1);
    const auto slope = [&](double contour_mm) {
        f.noise.set_level({1, contour_mm});
        return f.noise.count(state)->linear_rows(state)[0].normal.x();
    };
    EXPECT_NEAR(slope(0), 0.1, 1e-12);  // exact contours: those of the target
    EXPECT_LT(slope(0.3), slope(0.1));
    EXPECT_NEAR(slope(1.0), 0, 1e-12);  // all of them may be errors
    EXPECT_EQ(f.noise.count(state)->linear_rows(state, true)[0].normal, Vec3::UnitZ());
}

TEST(SurfaceNoise, FindsTheContoursErrorThatAMeanSquareBelongsTo) {
    Fixture f;
    f.noise.set_level({1, 0.4});
    const double b = f.mean_variance();
    EXPECT_NEAR(f.noise.contours_for(1.0).sd_mm, 0.4, 1e-4);
    EXPECT_NEAR(f.noise.contours_for(2.0).sd_mm, std::sqrt(2 * (0.16 + b) - b), 2e-3);
    EXPECT_NEAR(f.noise.contours_for(2.0).shown_share, 1, 1e-9);
}

TEST(SurfaceNoise, LeavesContoursOpenAsFarAsVoxelsMayExplainThem) {
    Fixture f;
    f.noise.set_level({1, 0.05});
    const double b = f.mean_variance(), nothing = b / (0.05 * 0.05 + b);
    const auto none = f.noise.contours_for(nothing);
    // The mean of half a normal distribution, of deviation b/3
    EXPECT_NEAR(none.sd_mm, std::sqrt(b / 3 * std::sqrt(2 / std::acos(-1.0))), 2e-3);
    EXPECT_NEAR(none.shown_share, 0, 0.02);

    double last = 0;
    for (const double factor : {1e-6, 0.3, 0.6, 1.0, 1.5}) {
        const auto found = f.noise.contours_for(factor);
        EXPECT_GT(found.sd_mm, last) << factor;
        EXPECT_GE(found.shown_share, 0);
        last = found.sd_mm;
    }
}

}  // namespace
}  // namespace palpate

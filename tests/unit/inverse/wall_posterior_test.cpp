// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/wall_posterior.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace palpate {
namespace {

constexpr Index num_nodes = 4;

/// Two walls, 0 - 1 - 2 and 3, seen by five rows of which two are at one node, one of them not on a
/// wall at all; all with dense matrices.
struct Case {
    std::mt19937 engine{5};
    std::normal_distribution<double> normal;
    Eigen::MatrixXd precision = make_precision();
    WallPrior prior{Eigen::SparseMatrix<double>(precision.sparseView())};
    Eigen::VectorXd driven = random(3 * num_nodes, 1);
    std::vector<LinearRow> rows = make_rows();
    FramePrior frame = make_frame();
    Eigen::MatrixXd covariance = by_component(precision.inverse());
    Eigen::MatrixXd along;   ///< G [rows on walls, 3 num_nodes]
    Eigen::MatrixXd turned;  ///< A [rows on walls, 6]
    Eigen::MatrixXd noise;   ///< R
    Eigen::VectorXd wanted;  ///< y, the alignment exact

    Case() {
        std::vector<LinearRow> seen;
        for (const LinearRow& row : rows)
            if (row.on_driven) seen.push_back(row);
        const Index n = static_cast<Index>(seen.size());
        along.setZero(n, 3 * num_nodes);
        turned.resize(n, 6);
        noise.resize(n, n);
        wanted.resize(n);
        for (Index i = 0; i < n; ++i) {
            along.block<1, 3>(i, 3 * seen[i].position) = seen[i].normal.transpose();
            turned.row(i) = frame.frame.row(seen[i].place, seen[i].normal);
            wanted[i] =
                seen[i].normal.dot(driven.segment<3>(3 * seen[i].position)) - seen[i].residual_mm;
            for (Index j = 0; j < n; ++j)
                noise(i, j) = i == j ? noise_variance(seen[i]) : noise_covariance(seen[i], seen[j]);
        }
    }

    Eigen::MatrixXd random(Index n, Index columns) {
        return Eigen::MatrixXd::NullaryExpr(n, columns, [&] { return normal(engine); });
    }
    static Eigen::MatrixXd make_precision() {
        Eigen::MatrixXd q = Eigen::MatrixXd::Zero(num_nodes, num_nodes);
        q.diagonal() << 0.5, 0.6, 0.4, 0.3;
        q(0, 1) = q(1, 0) = -0.2;
        q(1, 2) = q(2, 1) = -0.1;
        return q;
    }
    static Eigen::MatrixXd by_component(const Eigen::MatrixXd& matrix) {
        Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * matrix.rows(), 3 * matrix.cols());
        for (Eigen::Index i = 0; i < matrix.rows(); ++i)
            for (Eigen::Index j = 0; j < matrix.cols(); ++j)
                all.block<3, 3>(3 * i, 3 * j) = matrix(i, j) * Mat3::Identity();
        return all;
    }
    std::vector<LinearRow> make_rows() {
        std::vector<LinearRow> made;
        for (const Index node : {0, 1, 1, 2, 3}) {
            LinearRow row;
            row.on_driven = true;
            row.position = node;
            row.normal = Vec3(random(3, 1)).normalized();
            row.residual_mm = normal(engine);
            row.independent_mm = 0.3;
            row.contour_mm = 0.5;
            row.surface = node == 3 ? 1 : 0;
            row.place = 10 * Vec3(random(3, 1));
            made.push_back(row);
        }
        made.push_back(made.front());
        made.back().on_driven = false;
        return made;
    }
    FramePrior make_frame() {
        FramePrior made;
        made.frame.centre = Vec3(1, 2, 3);
        const Eigen::MatrixXd root = random(6, 6);
        made.covariance =
            0.05 * (root * root.transpose()) + 0.1 * FramePrior::Covariance::Identity();
        return made;
    }
};

// Everything below is compared with N(0, P) conditioned on y = H x + noise, by dense inverses:
// mean P H^T (H P H^T + R)^-1 y, covariance P - P H^T (..)^-1 H P.

TEST(WallPosterior, IsTheGaussianConditionedOnTheWallsDistances) {
    const Case c;
    const Eigen::MatrixXd gain = c.covariance * c.along.transpose() *
                                 (c.along * c.covariance * c.along.transpose() + c.noise).inverse();
    const Eigen::MatrixXd left = c.covariance - gain * c.along * c.covariance;
    const Eigen::MatrixXd functionals = Case().random(3 * num_nodes, 2).transpose();  // N

    const WallPosterior walls(c.prior, c.rows, c.driven);

    const Eigen::MatrixXd spread = c.covariance * functionals.transpose();
    EXPECT_LT((walls.mean() - gain * c.wanted).norm(), 1e-10);
    EXPECT_LT((walls.conditioned(spread.col(0)) - left * functionals.row(0).transpose()).norm(),
              1e-10);
    EXPECT_LT((walls.covariance_of(spread, functionals * spread) -
               functionals * left * functionals.transpose())
                  .norm(),
              1e-10);
    EXPECT_GT((left - c.covariance).norm(), 0.1 * c.covariance.norm());
}

TEST(WallPosterior, WithAnUncertainAlignmentIsTheJointGaussianOfWallsAndAlignment) {
    const Case c;
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(3 * num_nodes + 6, 3 * num_nodes + 6);  // P
    both.topLeftCorner(3 * num_nodes, 3 * num_nodes) = c.covariance;
    both.bottomRightCorner<6, 6>() = c.frame.covariance;
    Eigen::MatrixXd seen(c.along.rows(), both.rows());  // H
    seen << c.along, c.turned;
    const Eigen::MatrixXd gain =
        both * seen.transpose() * (seen * both * seen.transpose() + c.noise).inverse();
    const Eigen::VectorXd mean = gain * c.wanted;
    const Eigen::MatrixXd left = both - gain * seen * both;

    const WallPosterior walls(c.prior, c.rows, c.driven, c.frame);

    EXPECT_LT((walls.mean() - mean.head(3 * num_nodes)).norm(), 1e-10);
    EXPECT_LT((walls.frame_mean() - mean.tail<6>()).norm(), 1e-10);
    const Eigen::MatrixXd of_frame = walls.frame_root() * walls.frame_root().transpose();
    EXPECT_LT((of_frame - left.bottomRightCorner<6, 6>()).norm(), 1e-10);
    // cov(u, delta) = -D M^-1
    EXPECT_LT((-walls.frame_spread() * of_frame - left.topRightCorner(3 * num_nodes, 6)).norm(),
              1e-10);
}

TEST(WallPosterior, WithoutRowsIsThePrior) {
    const Case c;
    const WallPosterior walls(c.prior, {}, c.driven);
    const Eigen::VectorXd v = c.covariance.col(1);

    EXPECT_EQ(walls.mean().norm(), 0);
    EXPECT_EQ((walls.conditioned(v) - v).norm(), 0);
}

}  // namespace
}  // namespace palpate

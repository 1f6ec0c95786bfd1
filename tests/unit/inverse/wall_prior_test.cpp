// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/wall_prior.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <random>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr Index num_nodes = 5;

/// Two walls that share no node: 0 - 2 - 4 and 1 - 3.
Eigen::MatrixXd precision() {
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(num_nodes, num_nodes);
    q.diagonal() << 1.0, 0.8, 1.2, 0.9, 1.1;
    q(0, 2) = q(2, 0) = -0.4;
    q(2, 4) = q(4, 2) = -0.3;
    q(1, 3) = q(3, 1) = -0.5;
    return q;
}

WallPrior prior() { return WallPrior(Eigen::SparseMatrix<double>(precision().sparseView())); }

/// The same matrix for each of three components, which lie together node by node.
Eigen::MatrixXd by_component(const Eigen::MatrixXd& matrix) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * matrix.rows(), 3 * matrix.cols());
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        for (Eigen::Index j = 0; j < matrix.cols(); ++j)
            all.block<3, 3>(3 * i, 3 * j) = matrix(i, j) * Mat3::Identity();
    return all;
}

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns) {
    std::mt19937 engine(11);
    std::normal_distribution<double> normal;
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

/// The two walls with motions along normals, across them and as bodies told apart.
WallPrior prior_with_normals() {
    const WallPrior first = prior();
    std::vector<WallPrior::Wall> walls = first.walls();
    for (WallPrior::Wall& wall : walls) {
        const Index n = static_cast<Index>(wall.nodes.size());
        wall.normals = random_matrix(n, 3).rowwise().normalized();
        wall.tangential = 0.4;
        wall.rigid = 0.5 * random_matrix(3 * n, 6);
    }
    return WallPrior(first, walls);
}

/// From the formula: c_ij (n_i n_j^T + t^2 P_i P_j) + E_i E_j^T.
Eigen::MatrixXd dense_covariance(const WallPrior& walls) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * num_nodes, 3 * num_nodes);
    for (const WallPrior::Wall& wall : walls.walls())
        for (std::size_t i = 0; i < wall.nodes.size(); ++i)
            for (std::size_t j = 0; j < wall.nodes.size(); ++j) {
                const Vec3 a = wall.normals.row(i), b = wall.normals.row(j);
                const Mat3 across =
                    (Mat3::Identity() - a * a.transpose()) * (Mat3::Identity() - b * b.transpose());
                all.block<3, 3>(3 * wall.nodes[i], 3 * wall.nodes[j]) =
                    wall.covariance(i, j) *
                        (a * b.transpose() + wall.tangential * wall.tangential * across) +
                    wall.rigid.middleRows<3>(3 * i) * wall.rigid.middleRows<3>(3 * j).transpose();
            }
    return all;
}

TEST(WallPrior, WallsAreNodesThatHangTogether) {
    const WallPrior walls = prior();

    ASSERT_EQ(walls.walls().size(), 2u);
    EXPECT_EQ(walls.walls()[0].nodes, (std::vector<Index>{0, 2, 4}));
    EXPECT_EQ(walls.walls()[1].nodes, (std::vector<Index>{1, 3}));
}

TEST(WallPrior, CovarianceIsTheInverseOfThePrecision) {
    const Eigen::MatrixXd x = random_matrix(3 * num_nodes, 4);

    const Eigen::MatrixXd spread = prior().covariance_times(x);

    EXPECT_LT((by_component(precision()) * spread - x).norm(), 1e-12 * x.norm());
}

TEST(WallPrior, EnergyIsHalfTheSquareOfAMotion) {
    const Eigen::VectorXd u = random_matrix(3 * num_nodes, 1);

    EXPECT_NEAR(prior().energy(u), 0.5 * u.dot(by_component(precision()) * u), 1e-12);
}

TEST(WallPrior, MotionsAlongAndAcrossNormalsFollowTheirFormula) {
    const WallPrior walls = prior_with_normals();
    const Eigen::MatrixXd covariance = dense_covariance(walls);
    const Eigen::VectorXd u = random_matrix(3 * num_nodes, 1);

    const Eigen::MatrixXd found =
        walls.covariance_times(Eigen::MatrixXd::Identity(3 * num_nodes, 3 * num_nodes));

    EXPECT_LT((found - covariance).norm(), 1e-12 * covariance.norm());
    EXPECT_NEAR(walls.energy(u), 0.5 * u.dot(covariance.inverse() * u), 1e-9 * walls.energy(u));
}

TEST(WallPrior, CovarianceAlongDirectionsIsThatOfTheMotionsAlongThem) {
    const WallPrior walls = prior_with_normals();
    const Eigen::MatrixXd covariance = dense_covariance(walls);
    const std::vector<Index> at{2, 0, 0};
    const Eigen::Matrix<double, Eigen::Dynamic, 3> directions = random_matrix(3, 3);

    const Eigen::MatrixXd found = walls.walls()[0].covariance_along(at, directions);

    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Index a = walls.walls()[0].nodes[at[i]], b = walls.walls()[0].nodes[at[j]];
            const double expected = directions.row(i) * covariance.block<3, 3>(3 * a, 3 * b) *
                                    directions.row(j).transpose();
            EXPECT_NEAR(found(i, j), expected, 1e-12);
        }
}

TEST(WallPrior, SamplesSpreadAsTheCovarianceSays) {
    constexpr Index count = 40000;
    const Eigen::MatrixXd covariance = by_component(precision().inverse());

    const Eigen::MatrixXd drawn = prior().samples(count, 3);

    const Eigen::MatrixXd spread = drawn * drawn.transpose() / count;
    // Of a product of two numbers the deviation is at most sqrt(2) of their own, over sqrt(count).
    const double deviation = std::sqrt(2.0 / count) * covariance.maxCoeff();
    EXPECT_LT((spread - covariance).cwiseAbs().maxCoeff(), 5 * deviation);
    EXPECT_EQ((drawn - prior().samples(count, 3)).norm(), 0);
    EXPECT_GT((drawn - prior().samples(count, 4)).norm(), 0.5 * drawn.norm());
}

TEST(WallPrior, RefusesWhatIsNotDefinite) {
    Eigen::MatrixXd q = precision();
    q(1, 3) = q(3, 1) = -2;

    EXPECT_THROW(WallPrior(Eigen::SparseMatrix<double>(q.sparseView())), Error);
}

}  // namespace
}  // namespace palpate

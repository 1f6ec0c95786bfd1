// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/wall_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

namespace palpate {
namespace {

/// Nodes of a sphere of 20 mm, all in one wall.
struct Sphere {
    explicit Sphere(Index count) {
        for (Index k = 0; k < count; ++k) {  // Fibonacci's spiral
            const double z = 1 - 2 * (k + 0.5) / double(count);
            const double angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
            const double r = std::sqrt(1 - z * z);
            expected.normals.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
            expected.places.push_back(Vec3(100, 50, -30) + 20 * expected.normals.back());
        }
        Eigen::SparseMatrix<double> precision(count, count);
        for (Index k = 0; k < count; ++k) {
            precision.insert(k, k) = 0.1;
            if (k > 0) precision.insert(k - 1, k) = precision.insert(k, k - 1) = -0.01;
        }
        precision.makeCompressed();
        prior = std::make_unique<WallPrior>(precision, expected);
    }
    WallMotionScale scale(double normal_mm, double range_mm, double tangential) const {
        WallMotionScale result;
        result.walls = {{normal_mm, range_mm}};
        result.tangential = tangential;
        result.rigid_mm = 1.5;
        return result;
    }
    /// Between all components, node by node from the definition.
    static Eigen::MatrixXd dense(const WallPrior& walls) {
        const WallPrior::Wall& wall = walls.walls()[0];
        const Index n = walls.num_driven();
        Eigen::MatrixXd all = wall.rigid * wall.rigid.transpose();
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; j < n; ++j) {
                const Vec3 a = wall.normals.row(i), b = wall.normals.row(j);
                const Mat3 across_a = Mat3::Identity() - a * a.transpose();
                const Mat3 across_b = Mat3::Identity() - b * b.transpose();
                all.block<3, 3>(3 * i, 3 * j) +=
                    wall.covariance(i, j) *
                    (a * b.transpose() + wall.tangential * wall.tangential * across_a * across_b);
            }
        }
        return all;
    }
    WallExpectation expected;
    std::unique_ptr<WallPrior> prior;
};

TEST(FittedWalls, TellMotionAlongNormalsAndAlongTheWallApart) {
    const Sphere sphere(12);
    const auto walls = walls_of(*sphere.prior, sphere.scale(2, 30, 0.25));
    const Vec3 normal = sphere.expected.normals[3], along = normal.unitOrthogonal();
    // A body's motion adds 1.5^2 for the shift and as much for turns across the radius; 1.5 mm
    // along the wall are always possible.
    const Mat3 own = Sphere::dense(*walls).block<3, 3>(9, 9);
    EXPECT_NEAR(normal.dot(own * normal), 4 + 2.25, 0.02);
    EXPECT_NEAR(along.dot(own * along), 4 / 16.0 + 2.25 + 2 * 2.25, 0.35);
}

TEST(FittedWalls, CovarianceAlongDirectionsIsThatOfTheDenseOne) {
    const Sphere sphere(12);
    const auto walls = walls_of(*sphere.prior, sphere.scale(2, 15, 0.4));
    const Eigen::MatrixXd covariance = Sphere::dense(*walls);
    const std::vector<Index> at{7, 2, 7};
    Eigen::Matrix<double, Eigen::Dynamic, 3> directions(3, 3);
    directions << 0.6, 0, 0.8, 0, 1, 0, 0.48, 0.6, 0.64;
    const Eigen::MatrixXd seen = walls->walls()[0].covariance_along(at, directions);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const Vec3 a = directions.row(i), b = directions.row(j);
            const Mat3 block = covariance.block(3 * at[i], 3 * at[j], 3, 3);
            EXPECT_NEAR(seen(i, j), a.dot(block * b), 1e-9);
        }
    }
}

TEST(FittedWalls, EnergyAndProductsAreThoseOfTheDenseCovariance) {
    const Sphere sphere(12);
    const auto walls = walls_of(*sphere.prior, sphere.scale(2, 15, 0.4));
    const Eigen::MatrixXd covariance = Sphere::dense(*walls);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(36, 2, [&] { return normal(random); });

    EXPECT_LT((walls->covariance_times(x) - covariance * x).norm(), 1e-9 * x.norm());
    const Eigen::VectorXd u = x.col(0);
    const double energy = 0.5 * u.dot(covariance.ldlt().solve(u));
    EXPECT_NEAR(walls->energy(u), energy, 1e-6 * energy);
}

/// The distances of a wall that moves as drawn from a scale, seen with 0.05 mm of noise.
std::vector<LinearRow> drawn_rows(const Sphere& sphere, const WallMotionScale& scale,
                                  unsigned seed) {
    const Eigen::MatrixXd covariance = Sphere::dense(*walls_of(*sphere.prior, scale));
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd root = covariance.llt().matrixL();
    const Eigen::VectorXd u =
        root * Eigen::VectorXd::NullaryExpr(root.rows(), [&] { return normal(random); });
    std::vector<LinearRow> rows;
    for (std::size_t k = 0; k < sphere.expected.places.size(); ++k) {
        LinearRow row;
        row.on_driven = true;
        row.position = static_cast<Index>(k);
        row.normal = sphere.expected.normals[k];
        row.place = sphere.expected.places[k];
        row.independent_mm = 0.05;
        // Linearised at rest: residual + n . (u - 0) = 0 at the wall's own motion.
        row.residual_mm = -row.normal.dot(u.segment<3>(3 * row.position)) + 0.05 * normal(random);
        rows.push_back(row);
    }
    return rows;
}

TEST(FitWalls, FindsHowFarAWallMovedAndOverWhatLength) {
    const Sphere sphere(150);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(450);
    for (const unsigned seed : {1u, 2u, 3u}) {
        const auto little = fit_walls(
            *sphere.prior, drawn_rows(sphere, sphere.scale(1.2, 20, 0.3), seed), rest, {});
        const auto far =
            fit_walls(*sphere.prior, drawn_rows(sphere, sphere.scale(6, 20, 0.3), seed), rest, {});
        EXPECT_NEAR(std::log(little.walls[0].normal_mm / 1.2), 0, std::log(2.0));
        EXPECT_NEAR(std::log(far.walls[0].normal_mm / 6), 0, std::log(2.0));
        EXPECT_NEAR(std::log(little.walls[0].range_mm / 20), 0, std::log(1.6));
        EXPECT_NEAR(std::log(far.walls[0].range_mm / 20), 0, std::log(1.6));
    }
}

TEST(FitWalls, KeepsWhatIsExpectedOfWallsThatAreNotSeen) {
    Sphere sphere(30);
    sphere.expected.sd_mm = 10;
    sphere.expected.range_mm = 25;
    sphere.prior = std::make_unique<WallPrior>(sphere.prior->precision(), sphere.expected);
    const auto found = fit_walls(*sphere.prior, {}, Eigen::VectorXd::Zero(90), {});
    const auto expected = expected_scale(*sphere.prior);
    EXPECT_NEAR(found.walls[0].normal_mm, expected.walls[0].normal_mm, 0.05);
    EXPECT_NEAR(found.walls[0].range_mm, expected.walls[0].range_mm, 0.5);
    EXPECT_NEAR(found.tangential, expected.tangential, 0.01);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/response_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "host/apps/recover/inverse/linearised_problem.hpp"
#include "host/estimate/column_basis.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// A chain of walls and organ nodes whose coupling smooths, as tissue does: known background (1)
/// and one unknown organ (2) on the first half of the observed nodes.
struct Chain {
    static constexpr Index num_observed = 40, num_driven = 60;
    std::mt19937 random{11};
    std::normal_distribution<double> normal;
    ReducedModel model{regions(), num_observed, num_driven, {0, 10, 60}};
    WallPrior walls{precision()};

    Eigen::VectorXd noise(Index n) {
        return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
    }
    static CondensedRegion springs(Index region, Index first, Index last, double ground) {
        CondensedRegion result;
        result.region = region;
        for (Index k = first; k < last; ++k) result.observed.push_back(k);
        const Index n = last - first;
        result.observed_observed = ground * Eigen::MatrixXd::Identity(3 * n, 3 * n);
        for (Index k = 0; k + 1 < n; ++k) {
            for (int c = 0; c < 3; ++c) {
                const Index a = 3 * k + c, b = a + 3;
                result.observed_observed(a, a) += 1;
                result.observed_observed(b, b) += 1;
                result.observed_observed(a, b) -= 1;
                result.observed_observed(b, a) -= 1;
            }
        }
        result.observed_driven.resize(3 * n, 0);
        return result;
    }
    static std::vector<CondensedRegion> regions() {
        CondensedRegion background = springs(1, 0, num_observed, 0.5);
        for (Index d = 0; d < num_driven; ++d) background.driven.push_back(d);
        background.observed_driven = Eigen::MatrixXd::Zero(3 * num_observed, 3 * num_driven);
        for (Index k = 0; k < num_observed; ++k) {
            for (Index d = 0; d < num_driven; ++d) {
                const double gap = double(k) / num_observed - double(d) / num_driven;
                background.observed_driven.block<3, 3>(3 * k, 3 * d) =
                    -0.05 * std::exp(-40 * gap * gap) * Mat3::Identity();
            }
        }
        return {background, springs(2, 0, num_observed / 2, 0)};
    }
    static Eigen::SparseMatrix<double> precision() {
        Eigen::SparseMatrix<double> matrix(num_driven, num_driven);
        for (Index d = 0; d < num_driven; ++d) {
            matrix.insert(d, d) = 0.3;
            if (d + 1 == num_driven / 2 || d + 1 == num_driven) continue;  // two walls
            matrix.insert(d, d + 1) = -0.14;
            matrix.insert(d + 1, d) = -0.14;
        }
        return matrix;
    }
    std::vector<LinearRow> rows() {
        std::vector<LinearRow> result;
        for (const bool on_driven : {true, false}) {
            for (Index k = 0; k < (on_driven ? num_driven : num_observed); ++k) {
                LinearRow row;
                row.on_driven = on_driven;
                row.position = k;
                row.normal = Vec3(noise(3)).normalized();
                row.residual_mm = normal(random);
                row.independent_mm = 0.2;
                row.terraces.waves.col(0) = 0.3 * Eigen::Vector2d(std::cos(k), std::sin(k));
                row.surface = on_driven ? (k < num_driven / 2 ? 0 : 1) : 2;
                row.place = Vec3(k, 0, 0);
                row.range_mm[0] = 3;
                result.push_back(row);
            }
        }
        return result;
    }
};

TEST(ColumnBasis, LeavesOutNoMoreThanTheTolerance) {
    std::mt19937 random{3};
    std::normal_distribution<double> normal;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::NullaryExpr(30, 20, [&] { return normal(random); });
    for (Index c = 0; c < 20; ++c) matrix.col(c) *= std::pow(0.4, c);

    const Eigen::MatrixXd basis = orthonormal_columns(matrix, 1e-3);

    EXPECT_LT(basis.cols(), 12);
    EXPECT_LT((matrix - basis * (basis.transpose() * matrix)).norm(), 1.001e-3);
    EXPECT_LT(
        (basis.transpose() * basis - Eigen::MatrixXd::Identity(basis.cols(), basis.cols())).norm(),
        1e-10);
}

TEST(WallPrior, CovarianceIsTheInverseOfThePrecision) {
    Chain chain;
    const Eigen::VectorXd u = chain.noise(3 * Chain::num_driven);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(u.size(), u.size());
    const Eigen::MatrixXd scalar = Chain::precision();
    for (Index a = 0; a < Chain::num_driven; ++a)
        for (Index b = 0; b < Chain::num_driven; ++b)
            dense.block<3, 3>(3 * a, 3 * b) = scalar(a, b) * Mat3::Identity();

    EXPECT_EQ(chain.walls.walls().size(), 2u);
    EXPECT_LT((dense * chain.walls.covariance_times(u) - u).norm(), 1e-10 * u.norm());
    EXPECT_NEAR(chain.walls.energy(u), 0.5 * u.dot(dense * u), 1e-10 * u.squaredNorm());
}

TEST(WallPosterior, IsTheGaussianGivenTheWallsOwnRows) {
    Chain chain;
    const auto rows = chain.rows();
    const Eigen::VectorXd driven = 0.1 * chain.noise(3 * Chain::num_driven);
    const Index n = 3 * Chain::num_driven;
    const Eigen::MatrixXd prior = chain.walls.covariance_times(Eigen::MatrixXd::Identity(n, n));
    Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(Chain::num_driven, n);
    Eigen::MatrixXd noise(Chain::num_driven, Chain::num_driven);
    Eigen::VectorXd wanted(Chain::num_driven);
    for (Index i = 0; i < Chain::num_driven; ++i) {
        seen.block<1, 3>(i, 3 * i) = rows[i].normal.transpose();
        wanted[i] = rows[i].normal.dot(driven.segment<3>(3 * i)) - rows[i].residual_mm;
        for (Index j = 0; j < Chain::num_driven; ++j)
            noise(i, j) = i == j ? noise_variance(rows[i]) : noise_covariance(rows[i], rows[j]);
    }
    const Eigen::MatrixXd hessian = prior.inverse() + seen.transpose() * noise.inverse() * seen;
    const Eigen::MatrixXd covariance = hessian.inverse();
    const Eigen::VectorXd mean = covariance * (seen.transpose() * (noise.inverse() * wanted));

    const WallPosterior posterior(chain.walls, rows, driven);

    EXPECT_LT((posterior.mean() - mean).norm(), 1e-8 * mean.norm());
    EXPECT_LT((posterior.covariance_of(prior, prior) - covariance).norm(),
              1e-8 * covariance.norm());
    EXPECT_LT((posterior.conditioned(prior * driven) - covariance * driven).norm(),
              1e-8 * driven.norm());
}

TEST(ResponseModel, LeavesOutWhatItSays) {
    Chain chain;
    ResponseOptions options;
    options.tolerance_mm = 1e-3;
    const auto compressed = ResponseModel::compressed(chain.model, chain.walls, {2}, options);
    const auto walls = chain.walls.samples(5, 77);

    EXPECT_LT(compressed.num_functionals(), 120);
    EXPECT_LT(compressed.left_out_mm(), 1e-3);
    for (const double kpa : {3.5, 40.0, 700.0, 2500.0}) {
        for (Index k = 0; k < walls.cols(); ++k) {
            const Eigen::VectorXd exact =
                chain.model.observed_displacement({0, 10, kpa}, walls.col(k));
            const Eigen::VectorXd found =
                compressed.observed_displacement({0, 10, kpa}, walls.col(k));
            EXPECT_LT((found - exact).norm() / std::sqrt(double(Chain::num_observed)), 4e-3);
        }
    }
}

TEST(ResponseModel, GivesTheSameObjectiveAsTheExactModel) {
    Chain chain;
    ResponseOptions options;
    options.tolerance_mm = 1e-5;
    const auto exact = ResponseModel::exact(chain.model, chain.walls);
    const auto compressed = ResponseModel::compressed(chain.model, chain.walls, {2}, options);
    const auto rows = chain.rows();
    const Eigen::VectorXd driven = 0.1 * chain.noise(3 * Chain::num_driven);
    const Eigen::VectorXd observed = 0.1 * chain.noise(3 * Chain::num_observed);
    const std::vector<Unknown> unknowns{{2, std::log(60.0), 1.2}};
    const LinearisedProblem with_all(exact, chain.walls, rows, driven, observed, unknowns);
    const LinearisedProblem with_few(compressed, chain.walls, rows, driven, observed, unknowns);

    EXPECT_LT(with_few.rank(), with_all.rank());
    for (const double theta : {1.5, 4.0, 7.0}) {
        const auto a = with_all.evaluate(Eigen::VectorXd::Constant(1, theta), true);
        const auto b = with_few.evaluate(Eigen::VectorXd::Constant(1, theta), true);
        EXPECT_NEAR(a.objective, b.objective, 1e-4 * std::abs(a.objective));
        EXPECT_NEAR(a.gradient[0], b.gradient[0], 1e-3 * (1 + std::abs(a.gradient[0])));
        const auto motion = with_all.fit(Eigen::VectorXd::Constant(1, theta)).driven;
        const auto few_motion = with_few.fit(Eigen::VectorXd::Constant(1, theta)).driven;
        EXPECT_LT((motion - few_motion).norm(), 1e-3 * motion.norm());
    }
}

TEST(ResponseModel, IsDiagonalWhereOnlyItsUnknownModulusChanges) {
    Chain chain;
    const auto model = ResponseModel::compressed(chain.model, chain.walls, {2}, {});
    ASSERT_TRUE(model.is_diagonal_in(2));
    EXPECT_FALSE(model.is_diagonal_in(1));
    const Eigen::MatrixXd forces = Eigen::MatrixXd::Random(model.num_modes(), 3);
    // The last with a known modulus that is another.
    for (const auto& kpa : std::vector<std::vector<double>>{{0, 10, 4}, {0, 10, 900}, {0, 7, 60}}) {
        const Eigen::MatrixXd expected = model.stiffness(kpa).llt().solve(forces);
        EXPECT_LT((model.factorised_stiffness(kpa).solve(forces) - expected).norm(),
                  1e-8 * expected.norm());
        EXPECT_TRUE(model.is_stable(kpa));
    }
    EXPECT_FALSE(model.is_stable({0, 10, -2000}));
    EXPECT_THROW(model.factorised_stiffness({0, 10, -2000}), Error);
    EXPECT_FALSE(ResponseModel::compressed(chain.model, chain.walls, {1, 2}, {}).is_diagonal_in(2));
}

TEST(ResponseModel, TakenApartAndPutTogetherIsTheSame) {
    Chain chain;
    const auto model = ResponseModel::compressed(chain.model, chain.walls, {2}, {});

    const ResponseModel again(model.parts());

    const std::vector<double> kpa{0, 10, 33};
    const Eigen::VectorXd driven = chain.noise(3 * Chain::num_driven);
    EXPECT_EQ(again.observed_displacement(kpa, driven), model.observed_displacement(kpa, driven));
    EXPECT_EQ(again.significant_root(model.prior_covariance()),
              model.significant_root(model.prior_covariance()));
}

TEST(ResponseModel, ShiftedAnswersAreTheOldOnesMoved) {
    Chain chain;
    const ResponseModel model = ResponseModel::exact(chain.model, chain.walls);
    const Eigen::VectorXd shift = chain.noise(3 * Chain::num_observed),
                          walls = chain.noise(3 * Chain::num_driven);
    const ResponseModel twice = model.shifted_by(shift).shifted_by(shift);
    for (const double kpa : {20.0, 200.0}) {
        const std::vector<double> moduli{0, 10, kpa};
        const Eigen::VectorXd moved =
            twice.observed_displacement(moduli, walls) - model.observed_displacement(moduli, walls);
        EXPECT_LT((moved - 2 * shift).norm(), 1e-9 * shift.norm());
    }
}

TEST(ResponseModel, RefusesPartsThatDoNotFit) {
    Chain chain;
    auto parts = ResponseModel::compressed(chain.model, chain.walls, {2}, {}).parts();
    parts.regions.back().region = 3;

    EXPECT_THROW(ResponseModel{parts}, Error);
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/posterior.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

/// F = (theta - 1)^T A (theta - 1) / 2 with a prior N(2, 1) of either unknown in it.
class Paraboloid : public Objective {
public:
    Evaluation evaluate(const Eigen::VectorXd& theta, bool) const override {
        return {value(theta), 0, curvature() * (theta - best())};
    }
    std::vector<double> objectives(const std::vector<Eigen::VectorXd>& thetas) const override {
        std::vector<double> values;
        for (const auto& theta : thetas) values.push_back(value(theta));
        return values;
    }
    Eigen::MatrixXd hessian(const Eigen::VectorXd&) const override { return curvature(); }
    Eigen::MatrixXd seen_information(const Eigen::VectorXd&) const override {
        return curvature() - Eigen::Matrix2d::Identity();
    }
    const std::vector<Unknown>& unknowns() const override { return unknowns_; }

    static Eigen::Vector2d best() { return {1, 1}; }
    static Eigen::Matrix2d curvature() {
        Eigen::Matrix2d matrix;
        matrix << 30, 10, 10, 20;
        return matrix;
    }

private:
    static double value(const Eigen::VectorXd& theta) {
        const Eigen::Vector2d d = theta - best();
        return 0.5 * d.dot(curvature() * d);
    }
    std::vector<Unknown> unknowns_{{2, 2.0, 1.0}, {3, 2.0, 1.0}};
};

TEST(Posterior, CovarianceIsTheInverseOfTheCurvature) {
    const Eigen::Matrix2d product =
        laplace_covariance(Paraboloid(), Paraboloid::best()) * Paraboloid::curvature();

    EXPECT_LT((product - Eigen::Matrix2d::Identity()).norm(), 1e-12);
}

TEST(Posterior, AProfileAlongTheRidgeRisesAsTheMarginalDoes) {
    const Paraboloid problem;
    const Eigen::MatrixXd covariance = laplace_covariance(problem, Paraboloid::best());
    const double sd = std::sqrt(covariance(0, 0));

    const auto interval =
        profile_interval(profile_of(problem, Paraboloid::best(), covariance, 0), 1.0);

    EXPECT_NEAR(interval[0], 1 - 1.96 * sd, 1e-3);
    EXPECT_NEAR(interval[1], 1 + 1.96 * sd, 1e-3);
}

TEST(Posterior, EndsAreExcludedByTheDataNotByThePrior) {
    const Paraboloid problem;
    const Eigen::MatrixXd covariance = laplace_covariance(problem, Paraboloid::best());

    const auto far =
        excluded_ends(problem, Paraboloid::best(), covariance, 0, same_bounds(2, -2.0, 4.0));
    const auto near =
        excluded_ends(problem, Paraboloid::best(), covariance, 0, same_bounds(2, 0.9, 1.1));

    EXPECT_TRUE(far[0] && far[1]);
    EXPECT_FALSE(near[0] || near[1]);
}

TEST(Posterior, ProfileIntervalOfAParabolaIsTheGaussianOne) {
    Profile profile;
    const double sd = 0.2;
    for (int k = -40; k <= 40; ++k) {
        const double z = k / 10.0;
        profile.value.push_back(4.0 + z * sd);
        profile.objective.push_back(0.5 * z * z);
    }

    const auto interval = profile_interval(profile, 4.0);

    EXPECT_NEAR(interval[1], 4.0 + 1.96 * sd, 1e-3);
    EXPECT_NEAR(interval[0], 4.0 - 1.96 * sd, 1e-3);
}

TEST(Posterior, SingularValuesNarrowThePriorAlongTheirDirections) {
    const std::vector<Unknown> unknowns{{2, 4, 1.5}, {3, 4, 1.5}};
    Eigen::Matrix2d information;
    information << 5, 3, 3, 5;  // eigenvalues 8 along (1, 1), 2 along (1, -1)

    const ScaledSensitivity found = scaled_sensitivity(information, unknowns);

    EXPECT_NEAR(found.singular_values[0], 1.5 * std::sqrt(8.0), 1e-12);
    EXPECT_NEAR(found.singular_values[1], 1.5 * std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(std::abs(found.directions.col(0).dot(Eigen::Vector2d(1, 1))), std::sqrt(2.0),
                1e-12);
    // Posterior variance: half of each direction's.
    const double expected = 0.5 / (8 + 1 / 2.25) + 0.5 / (2 + 1 / 2.25);
    EXPECT_NEAR(std::pow(seen_sd(information, unknowns)[0], 2), expected, 1e-12);
}

TEST(Posterior, WithoutInformationThePriorIsLeft) {
    EXPECT_EQ(seen_sd(Eigen::MatrixXd::Zero(1, 1), {{2, 4, 1.2}})[0], 1.2);
}

}  // namespace
}  // namespace palpate

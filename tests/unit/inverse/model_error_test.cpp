// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/model_error.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace palpate {
namespace {

TEST(ModelError, ModelErrorAddsInQuadratureOnBothSides) {
    const double sd = 0.2;
    constexpr double wide_prior = 1e6;
    const KnownModulus told =
        with_model_error({80, {80 * std::exp(-1.96 * sd), 80 * std::exp(1.96 * sd)}, sd}, 90,
                         wide_prior, model_sd_ln);

    const double whole = std::hypot(data_sd_factor * sd, model_sd_ln);
    EXPECT_NEAR(told.sd_ln, whole, 1e-9);
    EXPECT_EQ(told.kpa, 90);
    EXPECT_NEAR(std::log(told.interval_kpa[1] / 90), 1.96 * whole, 1e-9);
    EXPECT_NEAR(std::log(told.interval_kpa[0] / 90), -1.96 * whole, 1e-9);
}

TEST(ModelError, EitherSideOfAnIntervalKeepsItsOwnWidth) {
    constexpr double prior = 1.2;
    const KnownModulus told = with_model_error({100, {80, 200}, 0.2}, 100, prior, model_sd_ln);
    EXPECT_LT(told.interval_kpa[0], 80);
    EXPECT_GT(told.interval_kpa[1], 200);
    EXPECT_GT(told.interval_kpa[1] / 100, 1.5 * 100 / told.interval_kpa[0]);

    const KnownModulus without_width = with_model_error({100, {100, 200}, 0.2}, 100, prior, 0.12);
    EXPECT_NEAR(std::log(100 / without_width.interval_kpa[0]),
                1.96 / std::hypot(1 / 0.12, 1 / prior), 1e-9);
    const KnownModulus without_data = with_model_error({100, {1, 1e4}, prior}, 100, prior, 0.12);
    EXPECT_NEAR(without_data.sd_ln, prior, 1e-12);
    EXPECT_NEAR(std::log(without_data.interval_kpa[1] / 100), 1.96 * prior, 1e-9);
}

/// The product of two normal densities: its mean and covariance.
std::pair<Eigen::VectorXd, Eigen::MatrixXd> product_of(const Eigen::VectorXd& mean_a,
                                                       const Eigen::MatrixXd& covariance_a,
                                                       const Eigen::VectorXd& mean_b,
                                                       const Eigen::MatrixXd& covariance_b) {
    const Eigen::MatrixXd a = covariance_a.inverse(), b = covariance_b.inverse();
    const Eigen::MatrixXd covariance = (a + b).inverse();
    return {covariance * (a * mean_a + b * mean_b), covariance};
}

TEST(ModelError, WhatIsToldIsThePriorWithDataOfWhichLessIsBelieved) {
    const double median = std::log(100.0);
    const std::vector<Unknown> priors{{0, median, 1.2}, {1, median, 0.7}};
    const Eigen::Vector2d prior_mean(median, median), of_data(std::log(20.0), std::log(400.0));
    const Eigen::Matrix2d prior = Eigen::Vector2d(1.44, 0.49).asDiagonal();
    for (const double model_sd : {0.12, 0.65})
        for (const double correlation : {0.0, -0.97}) {
            Eigen::Matrix2d data;
            data << 0.16, correlation * 0.4 * 0.6, correlation * 0.4 * 0.6, 0.36;
            const auto [found, covariance] = product_of(of_data, data, prior_mean, prior);
            const Eigen::Matrix2d less = data_sd_factor * data_sd_factor * data +
                                         model_sd * model_sd * Eigen::Matrix2d::Identity();
            const auto [told, told_covariance] = product_of(of_data, less, prior_mean, prior);

            const auto [mean, left_open] =
                believed_moduli(found, covariance, priors, Eigen::Vector2d::Constant(model_sd));

            EXPECT_LT((mean - told).norm(), 1e-9) << model_sd << ' ' << correlation;
            EXPECT_LT((left_open - told_covariance).norm(), 1e-9) << model_sd << ' ' << correlation;
            if (correlation == 0) {
                EXPECT_NEAR(sd_ln_with_model_error(std::sqrt(covariance(0, 0)), 1.2, model_sd),
                            std::sqrt(told_covariance(0, 0)), 1e-9);
            }
        }
}

KnownModulus normal_modulus(double kpa, double sd_ln) {
    return {kpa, {kpa * std::exp(-1.96 * sd_ln), kpa * std::exp(1.96 * sd_ln)}, sd_ln};
}

DoubtedModulus doubted(const KnownModulus& found) {
    return with_misled_data(found, found.sd_ln, {0, std::log(100.0), 1.2}).value();
}

TEST(MisledData, WhatIsExpectedIsNotDoubted) {
    // 95 % of what the prior expects, and somewhat more: 1,500 kPa is 2.3 of its deviations off.
    for (const double kpa : {8.0, 20.0, 100.0, 400.0, 1500.0})
        for (const double sd_ln : {0.13, 0.3, 0.6})
            EXPECT_LT(doubted(normal_modulus(kpa, sd_ln)).misled_probability,
                      contradiction_probability)
                << kpa << ' ' << sd_ln;
    EXPECT_NEAR(doubted(normal_modulus(100, 0.3)).misled_probability, misled_share, 0.007);
}

TEST(MisledData, FarFromThePriorTheIntervalReachesBackToIt) {
    // palpate phantom pelvis --seed 79801 of 56 kPa, slices of 3 mm: 3,800 [1,350, 13,900] kPa
    const auto [known, probability] = doubted({3800, {1350, 13900}, 0.6});

    EXPECT_NEAR(probability, 0.4, 0.1);
    EXPECT_LT(known.interval_kpa[0], 56);
    EXPECT_GT(known.interval_kpa[1], 10000);
    EXPECT_LT(known.interval_kpa[1], 13900);
    EXPECT_GT(known.sd_ln, 1.2 * 2 / 3);
    EXPECT_LT(known.kpa, 3800);
}

TEST(MisledData, TheSharperTheDataTheFartherOffTheyAreBelieved) {
    const double kpa = 2000;
    EXPECT_GT(doubted(normal_modulus(kpa, 0.6)).misled_probability, contradiction_probability);
    EXPECT_LT(doubted(normal_modulus(kpa, 0.2)).misled_probability, contradiction_probability);
}

TEST(MisledData, TheIntervalHasTwoAndAHalfPercentOfTheMixtureBeyondEitherEnd) {
    const double prior_mean = std::log(100.0);
    const auto [known, w] = doubted(normal_modulus(2500, 0.5));
    ASSERT_GT(w, 0.03);

    // Bayes on a grid, the likelihood a mixture of two normal densities of the data
    const double precision = 1 / 0.25 - 1 / 1.44;
    const double data = (std::log(2500.0) / 0.25 - prior_mean / 1.44) / precision;
    const auto density = [](double x, double about, double variance) {
        return std::exp(-(x - about) * (x - about) / (2 * variance)) / std::sqrt(variance);
    };
    double below = 0, above = 0, all = 0, first = 0;
    for (double x = -5; x < 20; x += 1e-4) {
        const double p =
            density(x, prior_mean, 1.44) * ((1 - misled_share) * density(x, data, 1 / precision) +
                                            misled_share * density(x, data, 25 / precision));
        all += p;
        first += p * x;
        if (x < std::log(known.interval_kpa[0])) below += p;
        if (x > std::log(known.interval_kpa[1])) above += p;
    }
    EXPECT_NEAR(below / all, 0.025, 2e-4);
    EXPECT_NEAR(above / all, 0.025, 2e-4);
    EXPECT_NEAR(std::log(known.kpa), first / all, 1e-3);
}

TEST(MisledData, DataThatTellNothingContradictNothing) {
    const Unknown prior{0, std::log(100.0), 1.2};
    EXPECT_FALSE(with_misled_data(normal_modulus(150, 1.2), 1.2, prior));
    EXPECT_FALSE(with_misled_data(normal_modulus(150, 0.5), NAN, prior));
    EXPECT_FALSE(with_misled_data({NAN, {1, 2}, 0.5}, 0.5, prior));
    // Far beyond what doubles can tell apart it is certain.
    EXPECT_NEAR(doubted(normal_modulus(1e30, 0.3)).misled_probability, 1, 1e-9);
}

TEST(ModelError, ModelErrorGrowsWithTheContours) {
    EXPECT_DOUBLE_EQ(model_sd_ln_with(0), model_sd_ln);
    const double half_a_millimetre_each = 0.5 * std::sqrt(2.0);
    EXPECT_NEAR(model_sd_ln_with(half_a_millimetre_each),
                std::hypot(model_sd_ln, 0.5 * model_sd_ln_per_contour_mm), 1e-12);
    EXPECT_DOUBLE_EQ(model_sd_ln_with(50), most_model_sd_ln);
}

TEST(ModelError, ModelErrorGrowsWithWhatTheMeshChanged) {
    for (const double change : {-0.3, 0.3})
        EXPECT_NEAR(model_sd_ln_with(0, change), std::hypot(model_sd_ln, 0.15), 1e-12);
    EXPECT_GT(model_sd_ln_with(50, 0.3), most_model_sd_ln);
}

}  // namespace
}  // namespace palpate

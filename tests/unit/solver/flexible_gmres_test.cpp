// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/flexible_gmres.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace palpate {
namespace {

constexpr Eigen::Index size = 40;

Eigen::MatrixXd symmetric_part() {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
        a(i, i) = 2 + 0.1 * std::cos(i);
        if (i > 0) a(i, i - 1) = a(i - 1, i) = -1;
    }
    return a;
}

Eigen::MatrixXd antisymmetric_part(double factor) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index i = 0; i + 3 < size; ++i) {
        a(i, i + 3) = factor * std::sin(i + 1.0);
        a(i + 3, i) = -a(i, i + 3);
    }
    return a;
}

VectorMap map_of(const Eigen::MatrixXd& a) {
    return [a](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
        to = a * from;
        return true;
    };
}

TEST(FlexibleGmres, SolvesWithTheSymmetricPartAsPreconditioner) {
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(size, -1, 2);
    int before = 0;
    for (const double factor : {0.0, 0.01, 0.5, 5.0}) {
        const Eigen::MatrixXd s = symmetric_part(), a = s + antisymmetric_part(factor);
        Eigen::VectorXd x;
        const GmresSummary found = flexible_gmres(map_of(a), map_of(s.inverse()), b, {}, x);
        EXPECT_LE(found.relative_residual, 1e-12) << factor;
        EXPECT_LT((a * x - b).norm(), 1e-11 * b.norm()) << factor;
        EXPECT_GE(found.iterations, before) << factor;
        before = found.iterations;
        if (factor == 0) {
            EXPECT_LE(found.iterations, 2);
        }
    }
}

TEST(FlexibleGmres, APreconditionerMayAnswerDifferentlyEachTime) {
    const Eigen::MatrixXd s = symmetric_part(), a = s + antisymmetric_part(0.3);
    int calls = 0;
    const Eigen::MatrixXd inverse = s.inverse();
    const VectorMap rough = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
        to = (1 + 0.01 * std::cos(++calls)) * (inverse * from);
        to[calls % size] *= 1.02;
        return true;
    };
    Eigen::VectorXd x;
    EXPECT_LE(
        flexible_gmres(map_of(a), rough, Eigen::VectorXd::Ones(size), {}, x).relative_residual,
        1e-12);
}

TEST(FlexibleGmres, RestartsAndStopsWhereItMay) {
    const Eigen::MatrixXd s = symmetric_part(), a = s + antisymmetric_part(0.2);
    const Eigen::VectorXd b = Eigen::VectorXd::Ones(size);
    Eigen::VectorXd x;
    GmresOptions options;
    options.restart = 8;
    EXPECT_LE(flexible_gmres(map_of(a), map_of(s.inverse()), b, options, x).relative_residual,
              1e-12);
    options.max_iterations = 3;
    const GmresSummary cut = flexible_gmres(map_of(a), map_of(s.inverse()), b, options, x);
    EXPECT_EQ(cut.iterations, 3);
    EXPECT_GT(cut.relative_residual, 1e-12);
    EXPECT_NEAR((a * x - b).norm() / b.norm(), cut.relative_residual, 1e-12);
}

TEST(FlexibleGmres, NothingIsTheAnswerToNothingAndAFailureIsTold) {
    const Eigen::MatrixXd s = symmetric_part();
    Eigen::VectorXd x;
    EXPECT_EQ(flexible_gmres(map_of(s), map_of(s), Eigen::VectorXd::Zero(size), {}, x).iterations,
              0);
    EXPECT_EQ(x.norm(), 0);
    const VectorMap fails = [](const Eigen::VectorXd&, Eigen::VectorXd&) { return false; };
    EXPECT_EQ(
        flexible_gmres(map_of(s), fails, Eigen::VectorXd::Ones(size), {}, x).relative_residual, 1);
}

}  // namespace
}  // namespace palpate

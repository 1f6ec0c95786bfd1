// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/joint_problem.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/fixtures/small_problem.hpp"

namespace palpate {
namespace {

using Problems = std::vector<std::shared_ptr<const LinearisedProblem>>;

/// Targets of one reference: rows at the same places, with the noise of contours.
struct Targets {
    SmallProblem base;
    std::vector<std::vector<LinearRow>> rows;

    explicit Targets(int count, double contour_mm = 0.6) {
        for (LinearRow& row : base.rows) {
            row.contour_mm = contour_mm;
            row.place = 4 * Vec3(base.noise(3));
            if (row.on_driven) row.surface = 1 + row.position;
        }
        rows.assign(count, base.rows);
    }
    std::shared_ptr<const LinearisedProblem> problem(int target) const {
        return std::make_shared<LinearisedProblem>(base.response, base.walls, rows[target],
                                                   base.driven, base.observed, base.unknowns);
    }
    Problems problems() const {
        Problems all;
        for (int k = 0; k < int(rows.size()); ++k) all.push_back(problem(k));
        return all;
    }
};

const Eigen::Vector2d theta(4.0, 3.2);

TEST(JointProblem, OfOneTargetIsItsOwn) {
    const Targets targets(1);
    const JointProblem joint(targets.problems());
    const auto alone = targets.problem(0);

    const auto of_all = joint.evaluate(theta, true), of_one = alone->evaluate(theta, true);
    EXPECT_NEAR(of_all.objective, of_one.objective, 1e-9);
    EXPECT_LT((of_all.gradient - of_one.gradient).norm(), 1e-5 * of_one.gradient.norm());
    EXPECT_LT((joint.hessian(theta) - alone->hessian(theta)).norm(),
              1e-2 * alone->hessian(theta).norm());
    EXPECT_LT((joint.seen_information(theta) - alone->seen_information(theta)).norm(), 1e-9);
    EXPECT_NEAR(misfits(joint, {theta})[0], misfits(*alone, {theta})[0], 1e-9);
}

/// Straight from the definition with dense matrices, e = y + G_o V s and B = -G_o V X of each.
TEST(JointProblem, ObjectiveIsTheDensityOfTheRowsOfAll) {
    Targets targets(2);
    for (LinearRow& row : targets.rows[1]) {
        row.residual_mm += 0.7;
        row.normal = Vec3(targets.base.noise(3)).normalized();
        row.contour_mm = 0.4;
    }
    const Problems problems = targets.problems();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(10, 10);
    Eigen::VectorXd error(10);
    for (int a = 0; a < 2; ++a) {
        const ObservedRows& seen = problems[a]->observed_rows();
        const Eigen::MatrixXd shapes = problems[a]->shapes(theta);
        const Index rank = problems[a]->rank();
        error.segment<5>(5 * a) = seen.target + seen.along_modes * shapes.col(rank);
        const Eigen::MatrixXd spread = seen.along_modes * shapes.leftCols(rank);
        covariance.block<5, 5>(5 * a, 5 * a) += spread * spread.transpose();
        for (int b = 0; b < 2; ++b) {
            const ObservedRows& other = problems[b]->observed_rows();
            for (Index i = 0; i < 5; ++i)
                for (Index j = 0; j < 5; ++j) {
                    const LinearRow &row = seen.rows[i], &column = other.rows[j];
                    const double contours = row.contour_mm * column.contour_mm *
                                            contour_correlation((row.place - column.place).norm());
                    covariance(5 * a + i, 5 * b + j) += (a == b ? 1.0 : 0.5) * contours;
                    if (a == b && i == j) covariance(5 * a + i, 5 * a + i) += 0.16;
                }
        }
    }
    double expected =
        0.5 * error.dot(covariance.inverse() * error) + 0.5 * std::log(covariance.determinant());
    for (int k = 0; k < 2; ++k) expected += 0.5 * std::pow((theta[k] - std::log(60.0)) / 1.2, 2);

    EXPECT_NEAR(JointProblem(problems).evaluate(theta, false).objective, expected,
                1e-9 * std::abs(expected));
}

/// Walls that are known exactly, nothing but the noise of contours.
Targets clean_walls(int count) {
    Targets targets(count, 2.0);
    targets.base.walls = WallPrior(SmallProblem::diagonal(SmallProblem::num_driven, 1e8));
    targets.base.response = ResponseModel::exact(targets.base.model, targets.base.walls);
    targets.base.driven.setZero();
    for (auto& rows : targets.rows)
        for (LinearRow& row : rows) {
            row.independent_mm = row.on_driven ? 1e-5 : 1e-3;
            if (row.on_driven) row.contour_mm = 0;
        }
    return targets;
}

double information_of(const JointProblem& joint) { return joint.seen_information(theta).trace(); }

TEST(JointProblem, TargetsOnOneSideNeverTellTwiceAsMuch) {
    const double one = information_of(JointProblem(clean_walls(1).problems()));
    for (const int count : {2, 4}) {
        const double all = information_of(JointProblem(clean_walls(count).problems()));
        EXPECT_NEAR(all / one, 2.0 * count / (count + 1), 1e-3) << count << " targets";
    }
}

TEST(JointProblem, SharesAreWhatEachTargetTellsOfWhatAllTell) {
    Targets targets = clean_walls(3);
    // The last is so noisy that it tells nothing.
    for (LinearRow& row : targets.rows[2])
        if (!row.on_driven) row.independent_mm = 1e4;
    const Eigen::MatrixXd shares = JointProblem(targets.problems()).shares(theta);
    for (int k = 0; k < 2; ++k) {
        EXPECT_NEAR(shares(0, k), 0.75, 0.02);  // of two that tell 4 / 3 as much as one
        EXPECT_NEAR(shares(1, k), 0.75, 0.02);
        EXPECT_LT(shares(2, k), 1e-3);
    }
}

TEST(JointProblem, TheErrorOfTheReferenceCancelsBetweenBothSides) {
    const double one = information_of(JointProblem(clean_walls(1).problems()));
    for (const int pairs : {1, 2}) {
        Targets targets = clean_walls(2 * pairs);
        for (int k = 0; k < pairs; ++k)
            for (LinearRow& row : targets.rows[k])
                if (row.on_driven) row.residual_mm = -row.residual_mm;
        const double all = information_of(JointProblem(targets.problems()));
        EXPECT_NEAR(all / one, 2.0 * 2 * pairs, 1e-2) << pairs << " on either side";
    }
}

}  // namespace
}  // namespace palpate

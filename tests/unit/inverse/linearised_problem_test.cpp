// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/linearised_problem.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "host/estimate/quasi_newton.hpp"
#include "tests/fixtures/small_problem.hpp"

namespace palpate {
namespace {

using Fixture = SmallProblem;

TEST(LinearisedProblem, ObjectiveIsTheDensityOfTheObservedRows) {
    // Straight from the definition with dense inverses: y ~ N(J m, R + J H^-1 J^T).
    Fixture f;
    const Eigen::Vector2d theta(4.0, 3.2);
    const ReducedModel& model = f.model;
    std::vector<double> kpa = model.stiffness_kpa();
    kpa[2] = std::exp(theta[0]);
    kpa[3] = std::exp(theta[1]);
    Eigen::MatrixXd hessian = 0.2 * Eigen::MatrixXd::Identity(12, 12);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(12);
    Eigen::MatrixXd normals = Eigen::MatrixXd::Zero(15, 5);
    Eigen::VectorXd target(5);
    for (const auto& row : f.rows) {
        const Index first = 3 * row.position;
        if (row.on_driven) {
            hessian.block<3, 3>(first, first) +=
                row.normal * row.normal.transpose() / (noise_variance(row));
            right.segment<3>(first) +=
                row.normal * (row.normal.dot(f.driven.segment<3>(first)) - row.residual_mm) /
                (noise_variance(row));
        } else {
            normals.block<3, 1>(first, row.position) = row.normal;
            target[row.position] = row.normal.dot(f.observed.segment<3>(first)) - row.residual_mm;
        }
    }
    Eigen::MatrixXd coupling(15, 12);
    for (Index c = 0; c < 12; ++c)
        coupling.col(c) = model.coupling_times(kpa, Eigen::VectorXd::Unit(12, c));
    const Eigen::MatrixXd jacobian =
        -normals.transpose() * model.stiffness(kpa).inverse() * coupling;
    const Eigen::VectorXd mean = hessian.inverse() * right;
    const Eigen::MatrixXd covariance = jacobian * hessian.inverse() * jacobian.transpose() +
                                       0.16 * Eigen::MatrixXd::Identity(5, 5);
    const Eigen::VectorXd error = target - jacobian * mean;
    double expected =
        0.5 * error.dot(covariance.inverse() * error) + 0.5 * std::log(covariance.determinant());
    for (int k = 0; k < 2; ++k) expected += 0.5 * std::pow((theta[k] - std::log(60.0)) / 1.2, 2);
    const Eigen::VectorXd best =
        mean + hessian.inverse() * jacobian.transpose() * covariance.inverse() * error;

    const auto fit = f.problem().fit(theta);

    EXPECT_NEAR(f.problem().evaluate(theta, false).objective, expected, 1e-9 * std::abs(expected));
    EXPECT_LT((fit.driven - best).norm(), 1e-9 * best.norm());
    EXPECT_NEAR(fit.weighted_misfit, 0.16 * (covariance.inverse() * error).squaredNorm(), 1e-9);
    EXPECT_NEAR(fit.effective_rows, 0.16 * covariance.inverse().trace(), 1e-9);
}

/// r = R C^-1 e with dense inverses, for noise that rows share.
TEST(LinearisedProblem, PredictsTheSizeOfTheResidualWithoutWeights) {
    Fixture f;
    for (LinearRow& row : f.rows) {
        row.contour_mm = 0.6;
        row.place = 4 * Vec3(f.noise(3));
        if (row.on_driven) row.surface = 1 + row.position;  // each node is a wall of its own here
    }
    const Eigen::Vector2d theta(4.0, 3.2);
    std::vector<double> kpa = f.model.stiffness_kpa();
    kpa[2] = std::exp(theta[0]);
    kpa[3] = std::exp(theta[1]);
    std::vector<LinearRow> seen, of_walls;
    for (const LinearRow& row : f.rows) (row.on_driven ? of_walls : seen).push_back(row);
    const auto covariance_of = [](const std::vector<LinearRow>& rows) {
        return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(
            rows.size(), rows.size(), [&](Eigen::Index i, Eigen::Index j) {
                return i == j ? noise_variance(rows[i]) : noise_covariance(rows[i], rows[j]);
            }));
    };
    const Eigen::MatrixXd noise = covariance_of(seen), wall_noise = covariance_of(of_walls);
    Eigen::MatrixXd normals = Eigen::MatrixXd::Zero(15, 5);
    Eigen::MatrixXd wall_normals = Eigen::MatrixXd::Zero(4, 12);
    Eigen::VectorXd target(5), wall_target(4);
    for (int k = 0; k < 5; ++k) {
        normals.block<3, 1>(3 * k, k) = seen[k].normal;
        target[k] = seen[k].normal.dot(f.observed.segment<3>(3 * k)) - seen[k].residual_mm;
    }
    for (int k = 0; k < 4; ++k) {
        wall_normals.block<1, 3>(k, 3 * k) = of_walls[k].normal.transpose();
        wall_target[k] =
            of_walls[k].normal.dot(f.driven.segment<3>(3 * k)) - of_walls[k].residual_mm;
    }
    const Eigen::MatrixXd precision = wall_noise.inverse();
    const Eigen::MatrixXd spread = (0.2 * Eigen::MatrixXd::Identity(12, 12) +
                                    wall_normals.transpose() * precision * wall_normals)
                                       .inverse();
    const Eigen::VectorXd mean = spread * wall_normals.transpose() * precision * wall_target;
    Eigen::MatrixXd coupling(15, 12);
    for (Index c = 0; c < 12; ++c)
        coupling.col(c) = f.model.coupling_times(kpa, Eigen::VectorXd::Unit(12, c));
    const Eigen::MatrixXd jacobian =
        -normals.transpose() * f.model.stiffness(kpa).inverse() * coupling;
    const Eigen::MatrixXd inverse = (noise + jacobian * spread * jacobian.transpose()).inverse();
    const Eigen::VectorXd residual = noise * inverse * (target - jacobian * mean);

    const auto fit = f.problem().fit(theta);

    EXPECT_NEAR(fit.misfit_mm2, residual.squaredNorm(), 1e-9);
    EXPECT_NEAR(fit.expected_misfit_mm2, (noise * inverse * noise).trace(), 1e-9);
    EXPECT_GT(std::abs(noise(0, 1)), 1e-3);
}

TEST(Contours, AreOffTheSameWayNearbyAndRoughly) {
    EXPECT_DOUBLE_EQ(contour_correlation(0), 1);
    EXPECT_NEAR(contour_correlation(contour_length_mm),
                (1 + std::sqrt(3)) * std::exp(-std::sqrt(3)), 1e-12);
    // Rough: the variogram begins with the square of the distance, but its next term is the cube.
    const double near = 1 - contour_correlation(0.1), twice = 1 - contour_correlation(0.2);
    EXPECT_LT(twice / near, 3.97);
    EXPECT_GT(twice / near, 3.8);
}

TEST(Contours, OfDifferentSurfacesAreDrawnIndependently) {
    LinearRow a, b;
    a.contour_mm = 0.5;
    b.contour_mm = 0.7;
    b.place = Vec3(3, 0, 0);
    EXPECT_NEAR(noise_covariance(a, b), 0.35 * contour_correlation(3), 1e-12);
    b.surface = 1;
    EXPECT_EQ(noise_covariance(a, b), 0);
    EXPECT_NEAR(noise_variance(b), 1 + 0.49, 1e-12);
}

/// The target's alignment as an unknown: the density of the observed rows given the walls', most
/// probable motions and their covariance, all from one dense Gaussian of all rows.
TEST(LinearisedProblem, IntegratesTheAlignmentOut) {
    Fixture f;
    FramePrior frame;
    frame.frame.centre = Vec3(1, -2, 3);
    const Eigen::MatrixXd root =
        Eigen::MatrixXd::NullaryExpr(6, 6, [&] { return f.normal(f.random); });
    frame.covariance = 0.1 * root * root.transpose() + 0.05 * Eigen::MatrixXd::Identity(6, 6);
    frame.motion << 0.3, -0.2, 0.1, 0.2, -0.4, 0.1;
    for (LinearRow& row : f.rows) row.place = 20 * Vec3(f.noise(3));
    const Eigen::Vector2d theta(4.0, 3.2);
    std::vector<double> kpa = f.model.stiffness_kpa();
    kpa[2] = std::exp(theta[0]);
    kpa[3] = std::exp(theta[1]);
    Eigen::MatrixXd coupling(15, 12);
    for (Index c = 0; c < 12; ++c)
        coupling.col(c) = f.model.coupling_times(kpa, Eigen::VectorXd::Unit(12, c));
    const Eigen::MatrixXd moves = -f.model.stiffness(kpa).inverse() * coupling;
    // Rows of (u_d, delta), the walls' first.
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(9, 18);
    Eigen::VectorXd y(9);
    Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(9, 9);
    for (int k = 0; k < 9; ++k) {
        const LinearRow& row = f.rows[k];
        if (row.on_driven)
            rows.block<1, 3>(k, 3 * row.position) = row.normal.transpose();
        else
            rows.row(k).head(12) = row.normal.transpose() * moves.middleRows<3>(3 * row.position);
        rows.row(k).tail(6) = frame.frame.row(row.place, row.normal).transpose();
        const Eigen::VectorXd& at = row.on_driven ? f.driven : f.observed;
        y[k] = row.normal.dot(at.segment<3>(3 * row.position)) +
               rows.row(k).tail(6).dot(frame.motion) - row.residual_mm;
        noise(k, k) = noise_variance(row);
    }
    Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(18, 18);
    prior.topLeftCorner(12, 12) = 5 * Eigen::MatrixXd::Identity(12, 12);  // 1 / 0.2
    prior.bottomRightCorner(6, 6) = frame.covariance;
    const Eigen::MatrixXd all = rows * prior * rows.transpose() + noise;
    const Eigen::MatrixXd of_walls = all.topLeftCorner(4, 4);
    double expected = 0.5 * y.dot(all.inverse() * y) + 0.5 * std::log(all.determinant()) -
                      0.5 * y.head(4).dot(of_walls.inverse() * y.head(4)) -
                      0.5 * std::log(of_walls.determinant());
    for (int k = 0; k < 2; ++k) expected += 0.5 * std::pow((theta[k] - std::log(60.0)) / 1.2, 2);
    const Eigen::MatrixXd gain = prior * rows.transpose() * all.inverse();
    const Eigen::VectorXd best = gain * y;
    const Eigen::MatrixXd left = prior - gain * rows * prior;

    const LinearisedProblem problem(f.response, f.walls, f.rows, f.driven, f.observed, f.unknowns,
                                    frame);
    const auto fit = problem.fit(theta);

    EXPECT_NEAR(problem.evaluate(theta, false).objective, expected, 1e-9 * std::abs(expected));
    EXPECT_LT((fit.driven - best.head(12)).norm(), 1e-9 * best.norm());
    EXPECT_LT((fit.frame - best.tail(6)).norm(), 1e-9 * best.norm());
    const Eigen::MatrixXd functionals = Eigen::MatrixXd::Identity(12, 12).leftCols(5);
    EXPECT_LT((problem.motion_covariance(theta, functionals) - left.topLeftCorner(5, 5)).norm(),
              1e-9 * left.norm());
    const auto gradient = problem.evaluate(theta, true).gradient;
    for (Index k = 0; k < 2; ++k) {
        const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(2, k);
        const double difference = (problem.evaluate(theta + step, false).objective -
                                   problem.evaluate(theta - step, false).objective) /
                                  2e-5;
        EXPECT_NEAR(gradient[k], difference, 1e-6 * std::max(1.0, std::abs(difference)));
    }
    const Eigen::MatrixXd information = problem.seen_information(theta);
    EXPECT_GT(information(0, 0), 0);
}

TEST(LinearisedProblem, GradientMatchesCentralDifferences) {
    Fixture f;
    const auto problem = f.problem();
    const Eigen::Vector2d theta(3.1, 4.4);
    const auto gradient = problem.evaluate(theta, true).gradient;

    for (Index k = 0; k < 2; ++k) {
        const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(2, k);
        const double difference = (problem.evaluate(theta + step, false).objective -
                                   problem.evaluate(theta - step, false).objective) /
                                  2e-5;
        EXPECT_NEAR(gradient[k], difference, 1e-6 * std::max(1.0, std::abs(difference)));
    }
}

TEST(LinearisedProblem, InformationIsThatOfTheDistancesAtTheMostProbableMotion) {
    // Central differences of the predicted distances, and a dense C.
    Fixture f;
    const Eigen::Vector2d theta(3.6, 4.1);
    const auto problem = f.problem();
    const Eigen::VectorXd motion = problem.fit(theta).driven;
    Eigen::MatrixXd normals = Eigen::MatrixXd::Zero(5, 15);
    Eigen::MatrixXd hessian = 0.2 * Eigen::MatrixXd::Identity(12, 12);
    for (const auto& row : f.rows) {
        const Index first = 3 * row.position;
        if (row.on_driven) {
            hessian.block<3, 3>(first, first) +=
                row.normal * row.normal.transpose() / noise_variance(row);
        } else {
            normals.block<1, 3>(row.position, first) = row.normal.transpose();
        }
    }
    const auto distances = [&](const Eigen::VectorXd& at, const Eigen::VectorXd& driven) {
        return Eigen::VectorXd(
            normals * f.response.observed_displacement(f.response.moduli({2, 3}, at), driven));
    };
    Eigen::MatrixXd jacobian(5, 12), change(5, 2);
    for (Index c = 0; c < 12; ++c) jacobian.col(c) = distances(theta, Eigen::VectorXd::Unit(12, c));
    for (Index k = 0; k < 2; ++k) {
        const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(2, k);
        change.col(k) = (distances(theta + step, motion) - distances(theta - step, motion)) / 2e-5;
    }
    const Eigen::MatrixXd covariance = jacobian * hessian.inverse() * jacobian.transpose() +
                                       0.16 * Eigen::MatrixXd::Identity(5, 5);
    const Eigen::MatrixXd expected = change.transpose() * covariance.inverse() * change;

    const Eigen::MatrixXd found = problem.seen_information(theta);

    EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm());
}

TEST(LinearisedProblem, MisfitIsTheObjectiveWithoutThePriorOfTheModuli) {
    Fixture f;
    const Eigen::Vector2d theta(3.6, 4.1);
    const auto problem = f.problem();
    double prior = 0;
    for (int k = 0; k < 2; ++k) prior += 0.5 * std::pow((theta[k] - std::log(60.0)) / 1.2, 2);

    EXPECT_NEAR(misfits(problem, {theta})[0] + prior, problem.evaluate(theta, false).objective,
                1e-9);
}

/// The same mechanics about another point, with forces there that do not balance.
struct MovedFixture : Fixture {
    const std::vector<double> kpa{0, 10, 35, 80};
    LinearisationPoint point{noise(3 * num_driven), noise(3 * num_observed)};
    std::vector<RegionForce> forces = some_forces();
    ResponseModel moved_response = at_the_point();

    std::vector<RegionForce> some_forces() {
        std::vector<RegionForce> made;
        for (const CondensedRegion& region : model.regions())
            made.push_back({region.region, noise(3 * num_observed)});
        return made;
    }
    ResponseModel at_the_point() const {
        ResponseModel::Parts parts = ResponseModel::exact(model, walls).parts();
        parts.point = point;
        for (std::size_t r = 0; r < forces.size(); ++r)
            parts.regions[r].force = parts.modes.transpose() * forces[r].force;
        return ResponseModel(parts);
    }
};

TEST(MarginalAtAPoint, ResponseIsThatOfTheReducedModel) {
    MovedFixture f;
    // u_o* - S^-1 (T (u_d - u_d*) + g), densely
    Eigen::VectorXd force = f.model.coupling_times(f.kpa, f.driven - f.point.driven);
    for (const RegionForce& own : f.forces) force += f.kpa[own.region] * own.force;
    const Eigen::VectorXd expected = f.point.observed - f.model.stiffness(f.kpa).inverse() * force;

    const Eigen::VectorXd answer = f.moved_response.observed_displacement(f.kpa, f.driven);

    EXPECT_LT((answer - expected).norm(), 1e-10 * expected.norm());
}

TEST(MarginalAtAPoint, GradientIsTheSlopeOfTheObjective) {
    MovedFixture f;
    const LinearisedProblem problem(f.moved_response, f.walls, f.rows, f.driven, f.observed,
                                    f.unknowns);
    const Eigen::Vector2d theta(4.0, 3.2);
    const double h = 1e-5;

    const auto here = problem.evaluate(theta, true);

    for (Index k = 0; k < 2; ++k) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(2, k);
        const double slope = (problem.evaluate(theta + step, false).objective -
                              problem.evaluate(theta - step, false).objective) /
                             (2 * h);
        EXPECT_NEAR(here.gradient[k], slope, 1e-6 * (1 + std::abs(slope)));
    }
}

TEST(MarginalAtAPoint, IsInfiniteWhereTheMechanicsAreNotStable) {
    MovedFixture f;
    ResponseModel::Parts parts = f.moved_response.parts();
    parts.regions[1].stiffness *= -0.1;  // what stress can do to a tangent
    const ResponseModel response(parts);
    const LinearisedProblem problem(response, f.walls, f.rows, f.driven, f.observed, f.unknowns);

    EXPECT_TRUE(std::isfinite(problem.evaluate(Eigen::Vector2d(0, 4), true).objective));
    EXPECT_TRUE(std::isinf(problem.evaluate(Eigen::Vector2d(9, 4), true).objective));
}

TEST(LinearisedProblem, SearchEndsWhereTheGradientVanishes) {
    Fixture f;
    const auto problem = f.problem();
    const Bounds bounds = same_bounds(2, std::log(0.01), std::log(1e6));

    const auto found = minimise_bfgs(problem, scan_grid(problem, bounds), bounds);

    // In posterior standard deviations: less than a hundredth of one from the minimum.
    const Eigen::VectorXd gradient = problem.evaluate(found.theta, true).gradient;
    EXPECT_LT(gradient.dot(problem.hessian(found.theta).llt().solve(gradient)), 1e-4);
    for (const double shift : {-0.05, 0.05}) {
        for (Index k = 0; k < 2; ++k) {
            const Eigen::VectorXd near = found.theta + shift * Eigen::VectorXd::Unit(2, k);
            EXPECT_GT(problem.evaluate(near, false).objective,
                      problem.evaluate(found.theta, false).objective);
        }
    }
}

}  // namespace
}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/quasi_newton.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int scan_points = 11;
constexpr int most_steps = 25;
constexpr double longest_step = 1.0;
constexpr double small_gradient = 0.003;  // in posterior standard deviations

/// Negative and tiny curvatures are replaced by the prior's, so that the step goes downhill.
Eigen::MatrixXd made_definite(const Eigen::MatrixXd& hessian,
                              const std::vector<Unknown>& unknowns) {
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
    double smallest = 1e300;
    for (const Unknown& unknown : unknowns)
        smallest = std::min(smallest, 1.0 / (unknown.sd * unknown.sd));
    const Eigen::VectorXd values = eigen.eigenvalues().cwiseAbs().cwiseMax(0.1 * smallest);
    return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

Eigen::MatrixXd prior_hessian(const std::vector<Unknown>& unknowns) {
    Eigen::VectorXd curvature(static_cast<Eigen::Index>(unknowns.size()));
    for (Eigen::Index k = 0; k < curvature.size(); ++k)
        curvature[k] = 1 / (unknowns[k].sd * unknowns[k].sd);
    return curvature.asDiagonal();
}

bool is_finite(const Objective::Evaluation& evaluation) {
    return std::isfinite(evaluation.objective) && evaluation.gradient.allFinite();
}

Eigen::VectorXd clamped(const Eigen::VectorXd& theta, const Bounds& bounds) {
    return theta.cwiseMax(bounds.lower).cwiseMin(bounds.upper);
}

/// BFGS; in one dimension this is the secant rule.
void update_hessian(const Eigen::VectorXd& step, const Eigen::VectorXd& change,
                    Eigen::MatrixXd& hessian) {
    const Eigen::VectorXd known = hessian * step;
    if (step.dot(change) < 1e-3 * step.norm() * change.norm() || step.dot(known) <= 0) return;
    hessian += change * change.transpose() / change.dot(step) -
               known * known.transpose() / step.dot(known);
}

}  // namespace

Bounds same_bounds(Index num_unknown, double lower, double upper) {
    return {Eigen::VectorXd::Constant(num_unknown, lower),
            Eigen::VectorXd::Constant(num_unknown, upper)};
}

Eigen::VectorXd scan_grid(const Objective& problem, const Bounds& bounds) {
    const std::vector<Unknown>& unknowns = problem.unknowns();
    const Index n = problem.num_unknown();
    Eigen::VectorXd best(n);
    for (Index k = 0; k < n; ++k) best[k] = unknowns[k].mean;
    if (n == 0) return best;
    double best_value = std::numeric_limits<double>::infinity();
    const auto offer = [&](const std::vector<Eigen::VectorXd>& points) {
        const std::vector<double> values = problem.objectives(points);
        for (std::size_t p = 0; p < points.size(); ++p) {
            if (!(values[p] < best_value)) continue;  // nor if it is no number
            best_value = values[p];
            best = points[p];
        }
    };
    std::vector<Eigen::VectorXd> together;
    for (int p = 0; p < scan_points; ++p) {  // prior mean +- 2.5 sd
        const double z = -2.5 + 5.0 * p / (scan_points - 1);
        Eigen::VectorXd theta = best;
        for (Index k = 0; k < n; ++k) theta[k] += z * unknowns[k].sd;
        together.push_back(clamped(theta, bounds));
    }
    offer(together);
    for (Index k = 0; n > 1 && k < n; ++k) {
        std::vector<Eigen::VectorXd> alone;
        for (const double shift : {-1.4, -0.7, 0.7, 1.4}) {
            alone.push_back(best);
            alone.back()[k] += shift;
            alone.back() = clamped(alone.back(), bounds);
        }
        offer(alone);
    }
    return best;
}

Minimum minimise_bfgs(const Objective& problem, const Eigen::VectorXd& start, const Bounds& bounds,
                      const Eigen::MatrixXd& hessian) {
    Minimum minimum;
    minimum.theta = start;
    auto here = problem.evaluate(start, true);
    if (!is_finite(here))
        throw Error(
            ErrorCode::solve_failed,
            "the objective is not a finite number where the search starts; check the settings for "
            "extreme values, or start elsewhere (--start-kpa)");
    minimum.start = here;
    const int most = problem.num_unknown() == 0 ? 0 : most_steps;
    minimum.hessian = hessian.size() > 0 ? hessian : problem.hessian(start);
    for (; minimum.steps < most; ++minimum.steps) {
        if (!minimum.hessian.allFinite()) minimum.hessian = prior_hessian(problem.unknowns());
        const Eigen::MatrixXd safe = made_definite(minimum.hessian, problem.unknowns());
        Eigen::VectorXd step = -safe.llt().solve(here.gradient);
        minimum.gradient_norm = std::sqrt(std::max(0.0, -here.gradient.dot(step)));
        if (minimum.gradient_norm < small_gradient) break;
        const double longest = step.cwiseAbs().maxCoeff();
        if (longest > longest_step) step *= longest_step / longest;
        double t = 1.0;
        Eigen::VectorXd next = clamped(minimum.theta + step, bounds);
        auto there = problem.evaluate(next, true);
        while (t > 1e-3 && !(is_finite(there) && there.objective <= here.objective)) {
            t *= 0.5;
            next = clamped(minimum.theta + t * step, bounds);
            there = problem.evaluate(next, true);
        }
        if (!is_finite(there) || t <= 1e-3 || (next - minimum.theta).cwiseAbs().maxCoeff() < 1e-9)
            break;
        update_hessian(next - minimum.theta, there.gradient - here.gradient, minimum.hessian);
        minimum.theta = next;
        here = std::move(there);
    }
    minimum.end = std::move(here);
    return minimum;
}

}  // namespace palpate

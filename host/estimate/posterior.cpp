// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/posterior.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate {

Eigen::MatrixXd laplace_covariance(const Objective& problem, const Eigen::VectorXd& theta) {
    const Eigen::MatrixXd hessian = problem.hessian(theta);
    if (hessian.size() == 0) return hessian;
    double floor = 1e300;
    for (const Unknown& unknown : problem.unknowns())
        floor = std::min(floor, 1.0 / (unknown.sd * unknown.sd));
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
    const Eigen::VectorXd inverse = eigen.eigenvalues().cwiseMax(floor).cwiseInverse();
    return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

double profile_half_width(const Eigen::MatrixXd& covariance, Index unknown) {
    return 4.0 * std::sqrt(covariance(unknown, unknown));
}

Profile profile_of(const Objective& problem, const Eigen::VectorXd& theta,
                   const Eigen::MatrixXd& covariance, Index unknown) {
    constexpr int half_points = 5;
    const double half_width = profile_half_width(covariance, unknown);
    const Eigen::VectorXd ridge = covariance.col(unknown) / covariance(unknown, unknown);
    Profile profile;
    std::vector<Eigen::VectorXd> points;
    for (int p = -half_points; p <= half_points; ++p) {
        points.push_back(theta + ridge * (half_width * p / half_points));
        profile.value.push_back(points.back()[unknown]);
    }
    profile.objective = problem.objectives(points);
    const double lowest = *std::min_element(profile.objective.begin(), profile.objective.end());
    for (double& value : profile.objective) value -= lowest;
    return profile;
}

std::array<double, 2> profile_interval(const Profile& profile, double best_value) {
    const auto& x = profile.value;
    const auto& f = profile.objective;
    const auto crossing = [&](std::size_t inside, std::size_t beyond) {
        // The root of the rise is linear for a Gaussian.
        const double t = (std::sqrt(profile_rise) - std::sqrt(f[inside])) /
                         (std::sqrt(f[beyond]) - std::sqrt(f[inside]));
        return (1 - t) * x[inside] + t * x[beyond];
    };
    std::size_t best = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        if (std::abs(x[k] - best_value) < std::abs(x[best] - best_value)) best = k;
    }
    std::array<double, 2> interval{x.front(), x.back()};
    for (std::size_t k = best; k + 1 < x.size(); ++k) {
        if (f[k + 1] > profile_rise) {
            interval[1] = crossing(k, k + 1);
            break;
        }
    }
    for (std::size_t k = best; k > 0; --k) {
        if (f[k - 1] > profile_rise) {
            interval[0] = crossing(k, k - 1);
            break;
        }
    }
    return interval;
}

Eigen::VectorXd seen_sd(const Eigen::MatrixXd& information, const std::vector<Unknown>& unknowns) {
    Eigen::MatrixXd precision = information;
    for (std::size_t k = 0; k < unknowns.size(); ++k)
        precision(k, k) += 1.0 / (unknowns[k].sd * unknowns[k].sd);
    return precision.inverse().diagonal().cwiseSqrt();
}

ScaledSensitivity scaled_sensitivity(const Eigen::MatrixXd& information,
                                     const std::vector<Unknown>& unknowns) {
    Eigen::VectorXd prior_sd(unknowns.size());
    for (std::size_t k = 0; k < unknowns.size(); ++k) prior_sd[k] = unknowns[k].sd;
    const Eigen::MatrixXd scaled = prior_sd.asDiagonal() * information * prior_sd.asDiagonal();
    if (scaled.size() == 0) return {};
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    return {eigen.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt(),
            eigen.eigenvectors().rowwise().reverse()};
}

std::array<bool, 2> excluded_ends(const Objective& problem, const Eigen::VectorXd& theta,
                                  const Eigen::MatrixXd& covariance, Index unknown,
                                  const Bounds& bounds) {
    const Eigen::VectorXd alone = Eigen::VectorXd::Unit(theta.size(), unknown);
    const Eigen::VectorXd ridge = covariance.col(unknown) / covariance(unknown, unknown);
    const double down = bounds.lower[unknown] - theta[unknown];
    const double up = bounds.upper[unknown] - theta[unknown];
    const std::vector<double> misfit =
        misfits(problem, {theta, theta + down * alone, theta + down * ridge, theta + up * alone,
                          theta + up * ridge});
    const double allowed = misfit[0] + profile_rise;
    return {std::min(misfit[1], misfit[2]) > allowed, std::min(misfit[3], misfit[4]) > allowed};
}

}  // namespace palpate

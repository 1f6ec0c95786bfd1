// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/uncertainty.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {

Eigen::MatrixXd laplace_covariance(const ModulusObjective& problem, const Eigen::VectorXd& theta) {
    const Eigen::MatrixXd hessian = problem.hessian(theta);
    if (hessian.size() == 0) return hessian;
    double floor = 1e300;
    for (const auto& prior : problem.priors()) {
        floor = std::min(floor, 1.0 / (prior.sd_ln * prior.sd_ln));
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
    const Eigen::VectorXd inverse = eigen.eigenvalues().cwiseMax(floor).cwiseInverse();
    return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

double profile_half_width(const Eigen::MatrixXd& covariance, Index unknown) {
    return 4.0 * std::sqrt(covariance(unknown, unknown));
}

ProfileResult profile_of(const ModulusObjective& problem, const Eigen::VectorXd& theta,
                         const Eigen::MatrixXd& covariance, Index unknown) {
    constexpr int half_points = 5;
    const double half_width = profile_half_width(covariance, unknown);
    const Eigen::VectorXd ridge = covariance.col(unknown) / covariance(unknown, unknown);
    ProfileResult profile;
    profile.region = problem.priors()[unknown].region;
    std::vector<Eigen::VectorXd> points;
    for (int p = -half_points; p <= half_points; ++p) {
        points.push_back(theta + ridge * (half_width * p / half_points));
        profile.stiffness_kpa.push_back(std::exp(points.back()[unknown]));
    }
    profile.objective = problem.objectives(points);
    const double lowest = *std::min_element(profile.objective.begin(), profile.objective.end());
    for (double& value : profile.objective) value -= lowest;
    return profile;
}

std::array<double, 2> profile_interval(const ProfileResult& profile, double best_kpa) {
    const auto& x = profile.stiffness_kpa;
    const auto& f = profile.objective;
    const auto crossing = [&](std::size_t inside, std::size_t beyond) {
        // The root of the rise is linear in ln E for a Gaussian.
        const double t = (std::sqrt(profile_rise) - std::sqrt(f[inside])) /
                         (std::sqrt(f[beyond]) - std::sqrt(f[inside]));
        return std::exp((1 - t) * std::log(x[inside]) + t * std::log(x[beyond]));
    };
    std::size_t best = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        if (std::abs(std::log(x[k] / best_kpa)) < std::abs(std::log(x[best] / best_kpa))) best = k;
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

Eigen::VectorXd seen_sd_ln(const Eigen::MatrixXd& information,
                           const std::vector<ModulusPrior>& priors) {
    Eigen::MatrixXd precision = information;
    for (std::size_t k = 0; k < priors.size(); ++k) {
        precision(k, k) += 1.0 / (priors[k].sd_ln * priors[k].sd_ln);
    }
    return precision.inverse().diagonal().cwiseSqrt();
}

ScaledSensitivity scaled_sensitivity(const Eigen::MatrixXd& information,
                                     const std::vector<ModulusPrior>& priors) {
    Eigen::VectorXd prior_sd(priors.size());
    for (std::size_t k = 0; k < priors.size(); ++k) prior_sd[k] = priors[k].sd_ln;
    const Eigen::MatrixXd scaled = prior_sd.asDiagonal() * information * prior_sd.asDiagonal();
    if (scaled.size() == 0) return {};
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    return {eigen.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt(),
            eigen.eigenvectors().rowwise().reverse()};
}

std::array<bool, 2> excluded_ends(const ModulusObjective& problem, const Eigen::VectorXd& theta,
                                  const Eigen::MatrixXd& covariance, Index unknown,
                                  const ModulusBounds& bounds) {
    const Eigen::VectorXd alone = Eigen::VectorXd::Unit(theta.size(), unknown);
    const Eigen::VectorXd ridge = covariance.col(unknown) / covariance(unknown, unknown);
    const double down = bounds.lower_ln[unknown] - theta[unknown];
    const double up = bounds.upper_ln[unknown] - theta[unknown];
    const std::vector<double> misfit =
        problem.misfits({theta, theta + down * alone, theta + down * ridge, theta + up * alone,
                         theta + up * ridge});
    const double allowed = misfit[0] + profile_rise;
    return {std::min(misfit[1], misfit[2]) > allowed, std::min(misfit[3], misfit[4]) > allowed};
}

std::array<double, 2> with_further_sd(const std::array<double, 2>& interval_kpa, double best_kpa,
                                      double sd_ln) {
    const double below = std::hypot(std::log(best_kpa / interval_kpa[0]), 1.96 * sd_ln);
    const double above = std::hypot(std::log(interval_kpa[1] / best_kpa), 1.96 * sd_ln);
    return {best_kpa * std::exp(-below), best_kpa * std::exp(above)};
}

double model_sd_ln_with(double contour_mm) {
    const double per_image = contour_mm / std::numbers::sqrt2;
    return std::min(most_model_sd_ln,
                    std::hypot(model_sd_ln, model_sd_ln_per_contour_mm * per_image));
}

namespace {

/// Of the data and the prior alone, what the data tell worth less.
double stretched_sd_ln(double sd_ln, double prior_sd_ln) {
    const double of_prior = 1.0 / (prior_sd_ln * prior_sd_ln);
    const double of_data = std::max(0.0, 1.0 / (sd_ln * sd_ln) - of_prior);
    return 1.0 / std::sqrt(of_data / (data_sd_factor * data_sd_factor) + of_prior);
}

}  // namespace

double sd_ln_with_model_error(double sd_ln, double prior_sd_ln, double contour_mm) {
    return std::hypot(stretched_sd_ln(sd_ln, prior_sd_ln), model_sd_ln_with(contour_mm));
}

std::array<double, 2> with_model_error(const std::array<double, 2>& interval_kpa, double best_kpa,
                                       double sd_ln, double prior_sd_ln, double contour_mm) {
    const double stretch = std::max(1.0, stretched_sd_ln(sd_ln, prior_sd_ln) / sd_ln);
    const std::array<double, 2> stretched{best_kpa * std::pow(interval_kpa[0] / best_kpa, stretch),
                                          best_kpa * std::pow(interval_kpa[1] / best_kpa, stretch)};
    return with_further_sd(stretched, best_kpa, model_sd_ln_with(contour_mm));
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/satterthwaite.hpp"

#include <Eigen/Cholesky>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// Step of ln s and ln length for derivatives of ln sd.
constexpr double log_step = 0.2;
constexpr double least_degrees = 2.0;
/// More are a normal distribution.
constexpr double most_degrees = 1e6;

/// ln sd of all parameters with one block's discrepancy changed.
Eigen::VectorXd log_sd(const std::vector<Parameter>& parameters, const Fit& fit, Index block,
                       const Discrepancy& discrepancy) {
    NoiseModel noise = *fit.noise;
    noise.set_discrepancy(block, discrepancy);
    const Eigen::MatrixXd hessian = normal_equations(parameters, *fit.prediction, noise).hessian;
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(hessian.rows(), hessian.cols());
    const Eigen::VectorXd variance = hessian.ldlt().solve(identity).diagonal();
    return 0.5 * variance.cwiseMax(1e-300).array().log();
}

/// d ln sd_k / d ln (s, length_mm, length_s) of one block, [num_parameter, 3].
Eigen::MatrixXd log_sd_slopes(const std::vector<Parameter>& parameters, const Fit& fit, Index block,
                              const Eigen::Matrix3d& covariance) {
    double Discrepancy::*const members[] = {&Discrepancy::amplitude, &Discrepancy::length_mm,
                                            &Discrepancy::length_s};
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(fit.values.size(), 3);
    for (int j = 0; j < 3; ++j) {
        if (covariance(j, j) == 0) continue;
        Discrepancy up = fit.noise->discrepancy(block), down = up;
        up.*members[j] *= std::exp(log_step);
        down.*members[j] *= std::exp(-log_step);
        slopes.col(j) =
            (log_sd(parameters, fit, block, up) - log_sd(parameters, fit, block, down)) /
            (2.0 * log_step);
    }
    return slopes;
}

}  // namespace

Eigen::VectorXd degrees_of_freedom(const std::vector<Parameter>& parameters, const Fit& fit) {
    // V_k = sum over blocks of a^T Sigma a
    Eigen::VectorXd variance = Eigen::VectorXd::Zero(fit.values.size());
    for (std::size_t b = 0; b < fit.discrepancy_covariance.size(); ++b) {
        const Eigen::Matrix3d& covariance = fit.discrepancy_covariance[b];
        if (covariance.isZero(0)) continue;
        const Eigen::MatrixXd slopes =
            log_sd_slopes(parameters, fit, static_cast<Index>(b), covariance);
        variance += (slopes * covariance).cwiseProduct(slopes).rowwise().sum();
    }
    return (0.5 * variance.cwiseMax(1e-300).cwiseInverse()).cwiseMax(least_degrees);
}

double student_reach(double degrees_of_freedom) {
    constexpr double quantile = 0.975;
    if (degrees_of_freedom > most_degrees)
        return boost::math::quantile(boost::math::normal(), quantile);
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom), quantile);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/quadratic_step.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double max_prior_sd = 3.0;

}  // namespace

bool stands_at_end(const TransformedRange& range, const Eigen::VectorXd& transformed,
                   const Eigen::VectorXd& gradient, Index k) {
    return (transformed[k] <= range.lower[k] && gradient[k] > 0) ||
           (transformed[k] >= range.upper[k] && gradient[k] < 0);
}

Eigen::VectorXd allowed_step(const std::vector<Parameter>& parameters,
                             const Eigen::VectorXd& transformed, Eigen::VectorXd step,
                             double max_change, double reach) {
    double share = 1;
    for (Index k = 0; k < step.size(); ++k) {
        const Parameter& parameter = parameters[k];
        const double longest = parameter.transform != Transform::identity ? max_change
                               : parameter.has_prior() ? max_prior_sd * parameter.sd
                                                       : std::numeric_limits<double>::infinity();
        if (std::abs(step[k]) * share > longest) share = longest / std::abs(step[k]);
    }
    step *= std::min(share, 1.0) * reach;
    const TransformedRange range = range_of(parameters);
    return (transformed + step).cwiseMax(range.lower).cwiseMin(range.upper) - transformed;
}

Eigen::VectorXd quadratic_step(const std::vector<Parameter>& parameters,
                               const Eigen::VectorXd& transformed,
                               const NormalEquations& equations) {
    const TransformedRange range = range_of(parameters);
    std::vector<Index> free;
    for (Index k = 0; k < transformed.size(); ++k)
        if (!parameters[k].is_held && !stands_at_end(range, transformed, equations.gradient, k))
            free.push_back(k);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(transformed.size());
    if (free.empty()) return step;
    // d = -H_ff^-1 g_f
    const Eigen::LDLT<Eigen::MatrixXd> factor(Eigen::MatrixXd(equations.hessian(free, free)));
    if (factor.info() != Eigen::Success || !factor.isPositive()) return step;
    const Eigen::VectorXd found = -factor.solve(equations.gradient(free));
    if (!found.allFinite()) return step;
    step(free) = found;
    return allowed_step(parameters, transformed, step);
}

double quadratic_gain(const NormalEquations& equations, const Eigen::VectorXd& step) {
    return -(equations.gradient.dot(step) + 0.5 * step.dot(equations.hessian * step));
}

}  // namespace palpate

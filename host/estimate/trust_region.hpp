// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>

namespace palpate {

struct TrustRegionOptions {
    double lower = 0, upper = 1;  ///< bounds of every unknown
    double first_step = 0.1;      ///< radius of the first quadratic
    double tolerance = 1e-3;      ///< the search ends when it would change unknowns by less
    int max_evaluations = 100;
};

struct TrustRegionMinimum {
    Eigen::VectorXd x;  ///< the lowest point that was evaluated
    double value = 0;
    int evaluations = 0;
    bool converged = false;  ///< whether the search ended by its tolerance
};

/// Minimum of a function without derivatives between bounds: quadratic interpolation in a trust
/// region (BOBYQA, Powell 2009, of NLopt). The first evaluation is at `start`, brought within the
/// bounds. Exceptions of `function` come through; a value that is not finite throws
/// Error(solve_failed).
TrustRegionMinimum minimise_in_trust_region(
    const std::function<double(const Eigen::VectorXd&)>& function, const Eigen::VectorXd& start,
    const TrustRegionOptions& options);

}  // namespace palpate

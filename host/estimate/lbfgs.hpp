// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace palpate {

struct LbfgsOptions {
    double relative_tolerance = 1e-4;  ///< stop after two steps in a row that change the value less
    int max_evaluations = 1000;        ///< of value and gradient together
    double time_limit_s = 0;           ///< 0: none; looked at between evaluations
    Eigen::VectorXd lower, upper;      ///< bounds of x, or empty
};

struct LbfgsResult {
    Eigen::VectorXd x;  ///< the lowest point that was evaluated
    double value = 0;
    /// How far a step of minus the gradient leads within the bounds, at `x` and at the start. The
    /// library's word that it converged is not trusted where it did not move and this is large.
    double gradient = 0, start_gradient = 0;
    int evaluations = 0;
    bool converged = false;
    std::string reason;  ///< why it stopped, one clause
};

/// Value of a smooth function at x; writes its gradient, which has the size of x.
using DifferentiableFunction =
    std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& gradient)>;

/// Limited-memory BFGS of NLopt (LD_LBFGS), started at `x` with a step of minus the gradient: scale
/// the function so that this is a sensible first step. Where value or gradient are not finite the
/// search turns back. Exceptions of `function` come through. Throws Error(solve_failed) if nothing
/// is finite at the start or beside it, Error(invalid_argument) for a start out of bounds.
LbfgsResult minimise_lbfgs(const DifferentiableFunction& function, const Eigen::VectorXd& x,
                           const LbfgsOptions& options);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/inverse/marginal.hpp"

namespace palpate {

/// Where ln E may be, [num unknown] each.
struct ModulusBounds {
    Eigen::VectorXd lower_ln, upper_ln;
};
ModulusBounds same_bounds(Index num_unknown, double lower_ln, double upper_ln);

/// Best point of a coarse grid of ln E: all unknown moduli together, then each in turn. Points
/// where F is not finite do not count; the priors' means if there are no others.
Eigen::VectorXd scan_moduli(const ModulusObjective& problem, const ModulusBounds& bounds);

struct ModulusMinimum {
    Eigen::VectorXd theta;
    Eigen::MatrixXd hessian;           ///< as far as the search knows it, near `theta`
    double gradient_norm = 0;          ///< sqrt(g . H^-1 g): distance to the minimum in sd
    double start_log_determinant = 0;  ///< ln det C at the start
    double log_determinant = 0;        ///< ln det C at `theta`
    ModulusObjective::Fit fit;         ///< at `theta`
    int steps = 0;
};

/// Quasi-Newton (BFGS) with a step limit and backtracking on F, from `start`, to a scaled gradient
/// of 1e-3. It begins with `hessian`, from an earlier search nearby, or computes it if that is
/// empty. It never goes where F or its gradient is not finite. Throws Error(solve_failed) if they
/// are not finite at the start.
ModulusMinimum minimise_moduli(const ModulusObjective& problem, const Eigen::VectorXd& start,
                               const ModulusBounds& bounds, const Eigen::MatrixXd& hessian = {});

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/estimate/objective.hpp"

namespace palpate {

/// Where unknowns may be, [num_unknown] each.
struct Bounds {
    Eigen::VectorXd lower, upper;
};
Bounds same_bounds(Index num_unknown, double lower, double upper);

/// Best point of a coarse grid: all unknowns together over 2.5 standard deviations of their priors
/// to either side, then each in turn by 0.7 and 1.4. Points where F is not finite do not count; the
/// priors' means if there are no others.
Eigen::VectorXd scan_grid(const Objective& problem, const Bounds& bounds);

struct Minimum {
    Eigen::VectorXd theta;
    Eigen::MatrixXd hessian;      ///< as far as the search knows it, near `theta`
    double gradient_norm = 0;     ///< sqrt(g . H^-1 g): distance to the minimum in sd
    Objective::Evaluation start;  ///< where the search began
    Objective::Evaluation end;    ///< at `theta`
    int steps = 0;
};

/// Quasi-Newton (BFGS) with a step limit of 1 and backtracking on F, from `start`, to a scaled
/// gradient of 3e-3. It begins with `hessian`, from an earlier search nearby, or computes it if
/// that is empty. It never goes where F or its gradient is not finite. Throws Error(solve_failed)
/// if they are not finite at the start.
Minimum minimise_bfgs(const Objective& problem, const Eigen::VectorXd& start, const Bounds& bounds,
                      const Eigen::MatrixXd& hessian = {});

}  // namespace palpate

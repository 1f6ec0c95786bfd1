// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/inverse/marginal.hpp"

namespace palpate {

struct ModulusBounds {
    double lower_ln = 0, upper_ln = 0;
};

/// Best point of a coarse grid of ln E: all unknown moduli together, then each in turn.
Eigen::VectorXd scan_moduli(const LinearisedProblem& problem, const ModulusBounds& bounds);

struct ModulusMinimum {
    Eigen::VectorXd theta;
    Eigen::MatrixXd hessian;      ///< at the start of the last step
    double gradient_norm = 0;     ///< sqrt(g . H^-1 g): distance to the minimum in sd
    int steps = 0;
};

/// Newton with a step limit and backtracking on F, from `start`, to a scaled gradient of 1e-4.
ModulusMinimum minimise_moduli(const LinearisedProblem& problem, const Eigen::VectorXd& start,
                               const ModulusBounds& bounds);

}  // namespace palpate

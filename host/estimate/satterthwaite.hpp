// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "host/estimate/fit.hpp"

namespace palpate {

/// Degrees of freedom [num_parameter] with which the sd of each parameter is known, since the
/// discrepancies on which it rests are learned from the same data: with V_k the variance of
/// ln sd_k that the uncertain ln s and ln lengths leave,
///     nu_k = 1 / (2 V_k),
/// as of a chi squared variance (Satterthwaite 1946; for learned covariances Kenward and Roger
/// 1997). Infinite where the discrepancies do not matter or were not learned; at least 2.
Eigen::VectorXd degrees_of_freedom(const std::vector<Parameter>& parameters, const Fit& fit);

/// Half a 95 % interval in units of sd: the 97.5 % quantile of Student's t; 1.96 for infinite nu.
double student_reach(double degrees_of_freedom);

}  // namespace palpate

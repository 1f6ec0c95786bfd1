// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "host/estimate/parameter.hpp"
#include "host/estimate/posterior.hpp"

namespace palpate {

/// A combination of parameters that the data know well, or badly.
struct Combination {
    /// a [num_parameter]: the combination is sum a_k t_k, the largest |a_k| is 1.
    Eigen::VectorXd coefficients;
    double singular_value = 0;  ///< of its direction among the prior-scaled sensitivities
    double sd = 0;              ///< posterior, of the sum
    std::string words;          ///< "mu * gamma^0.3 is known to 2 %"
};

/// Singular values and directions of the data's information over the priors' sd (`posterior.hpp`);
/// where a prior is flat, over 1 of a log or logit, and over the size of the value otherwise.
ScaledSensitivity prior_scaled_sensitivity(const std::vector<Parameter>& parameters,
                                           const Eigen::VectorXd& values,
                                           const Eigen::MatrixXd& information);

/// The combination along direction `which` of a sensitivity. Its words leave out coefficients below
/// a tenth of the largest: logs are a product of powers, anything else is a sum. "Known to" is half
/// the 95 % interval.
Combination combination_of(const std::vector<Parameter>& parameters, const Eigen::VectorXd& values,
                           const Eigen::MatrixXd& covariance, const ScaledSensitivity& sensitivity,
                           Eigen::Index which);

}  // namespace palpate

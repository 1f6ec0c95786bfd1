// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/estimate/noise_model.hpp"
#include "host/estimate/parameter.hpp"

namespace palpate {

/// Of a log or logit parameter in one step.
inline constexpr double usual_max_change = 0.7;

/// Whether parameter k is at a hard end and F falls beyond it.
bool stands_at_end(const TransformedRange& range, const Eigen::VectorXd& transformed,
                   const Eigen::VectorXd& gradient, Index k);

/// A step on the transformed scale, [num_parameter], as a whole shortened where it changes a log or
/// logit parameter by more than `max_change`, or one with a prior on its own scale by more than
/// three of its sd, then times `reach`; none leaves its range.
Eigen::VectorXd allowed_step(const std::vector<Parameter>& parameters,
                             const Eigen::VectorXd& transformed, Eigen::VectorXd step,
                             double max_change = usual_max_change, double reach = 1);

/// The allowed step to the minimum of the quadratic, -H^-1 g over the parameters that are not held
/// and not at an end beyond which F falls; zero for the others, and where H is not positive
/// definite.
Eigen::VectorXd quadratic_step(const std::vector<Parameter>& parameters,
                               const Eigen::VectorXd& transformed,
                               const NormalEquations& equations);

/// How far the quadratic of F falls along a step: -(g^T d + d^T H d / 2).
double quadratic_gain(const NormalEquations& equations, const Eigen::VectorXd& step);

}  // namespace palpate

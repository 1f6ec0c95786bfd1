// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/estimate/nlopt_search.hpp"

namespace palpate {

/// Minimum of a function without derivatives between bounds by the simplex of Nelder and Mead
/// (1965, of NLopt, which keeps it within bounds as Box did). Slow and robust, for one unknown or
/// more; `first_step` is the edge of the first simplex. The first evaluation is at `start`, brought
/// within the bounds. Exceptions of `function` come through; a value that is not finite throws
/// Error(solve_failed).
NloptMinimum minimise_by_simplex(const std::function<double(const Eigen::VectorXd&)>& function,
                                 const Eigen::VectorXd& start, const NloptOptions& options);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/estimate/nlopt_search.hpp"

namespace palpate {

/// Minimum of a function without derivatives between bounds: quadratic interpolation in a trust
/// region (BOBYQA, Powell 2009, of NLopt). The first evaluation is at `start`, brought within the
/// bounds. Exceptions of `function` come through; a value that is not finite throws
/// Error(solve_failed).
NloptMinimum minimise_in_trust_region(const std::function<double(const Eigen::VectorXd&)>& function,
                                      const Eigen::VectorXd& start, const NloptOptions& options);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "host/apps/identify/experiment.hpp"

namespace palpate {

/// Where to look for the numbers of an experiment whose first material has more relaxation terms
/// than another one's, which has at least one: the strongest term becomes two with half of its part
/// each, one twice as fast and one twice as slow, until there are enough.
///   from     the experiment with fewer terms, else the same
///   values   [num_parameter] of it
/// Gives values for `to` [num_parameter]; its own starts where `from` has no such number.
Eigen::VectorXd start_with_more_terms(const Experiment& from, const Eigen::VectorXd& values,
                                      const Experiment& to);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/estimate/gauss_newton.hpp"
#include "host/estimate/nlopt_search.hpp"

namespace palpate {

/// The minimum that `minimise_gauss_newton` looks for, found without columns: Nelder and Mead or
/// BOBYQA on the transformed scale, in units of a step that makes sense for each parameter (0.3 of
/// a log or logit; else the prior's sd, or a tenth of the start). A prediction that fails counts as
/// a value above all that were met. Only the end is predicted with columns. Throws
/// Error(solve_failed) if the prediction at the start fails.
GaussNewtonMinimum minimise_without_columns(const DataProblem& problem, NoiseModel& noise,
                                            const GaussNewtonStart& start, NloptSearch search,
                                            int max_evaluations, const ProgressSink& progress = {});

}  // namespace palpate

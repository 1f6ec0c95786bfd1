// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/estimate/data_problem.hpp"
#include "host/estimate/discrepancy_range.hpp"
#include "host/estimate/noise_model.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct DiscrepancyOptions {
    bool is_learned = true;  ///< false: blocks keep no discrepancy, or that of `given`
    /// One for each block: where the learning begins, or what is held. Empty: none.
    std::vector<Discrepancy> given;
    int max_rounds = 10;  ///< of search and learning
    /// Settled when no ln s changes by more than this, and no ln length by three times this.
    double tolerance = 0.1;
};

/// Discrepancies of all blocks by marginal likelihood: the residuals are linear in the parameters
/// around `prediction` (which has columns), with the parameters and the field integrated out,
///     -2 ln p = ln det C + ln det H + r^T C^-1 r - b^T H^-1 b + const,
///     H = J^T C^-1 J + P^-1,    b = J^T C^-1 r + P^-1 (m - t),
/// plus weak priors, between hard ends (Rasmussen and Williams 2006, equations 2.45 and 5.8).
/// Blocks are taken in turn, those with `has_discrepancy` only.
///
/// Rows whose independent noise is beyond `huber_sd` robust sd of it are taken to have noise as
/// large as what they show: weighed by Huber alone they would be explained as a field of short
/// length. Blocks of more than some 2,500 rows are averaged over neighbouring times for this, or
/// thinned where rows have no times. `progress` may throw to cancel.
std::vector<Discrepancy> learn_discrepancies(const std::vector<Parameter>& parameters,
                                             const Prediction& prediction, const NoiseModel& noise,
                                             const ProgressSink& progress = {});

/// How uncertain those are: for each block the covariance of ln s, ln length_mm and ln length_s by
/// the curvature of ln p there (Laplace); 0 for what is known, at a hard end, or not learned.
std::vector<Eigen::Matrix3d> discrepancy_covariances(const std::vector<Parameter>& parameters,
                                                     const Prediction& prediction,
                                                     const NoiseModel& noise);

/// A block with at most about `max_rows` rows: weighted means over neighbouring times at each
/// place, or every n-th row if there are no times. Of measured, predicted, columns and coordinates;
/// sd is that of the mean.
DataBlock thinned_block(const DataBlock& block, Index max_rows);

}  // namespace palpate

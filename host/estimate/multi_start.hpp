// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host/estimate/fit.hpp"

namespace palpate {

/// What came of one start, plain enough to be kept.
struct StartOutcome {
    int number = 0;          ///< of the start, from 0
    Eigen::VectorXd start;   ///< [num_parameter] on the parameters' own scales
    Eigen::VectorXd values;  ///< where the search ended; empty if the model had no prediction
    double objective = 0;    ///< minus the log posterior there
    Ending ending = Ending::converged;
    std::vector<Discrepancy> discrepancies;  ///< one for each block
    int num_prediction = 0;
    std::string failure;  ///< why there is no end, or empty

    bool is_found() const { return values.size() > 0; }
};

/// One line of JSON without its line break, numbers to 17 digits: what is read back is the same.
std::string json_line(const StartOutcome& outcome);
/// Throws Error(input_unreadable), saying what is missing or of the wrong kind.
StartOutcome start_outcome_of(std::string_view line);

struct MultiStartOptions {
    FitOptions fit;
    int num_start = 8;       ///< the parameters' own starts first, then draws from their priors
    std::uint32_t seed = 1;  ///< of the draws: start k is the same whatever num_start is
    /// Starts that are given, [num_parameter] each on the parameters' own scales, in place of
    /// draws.
    std::vector<Eigen::VectorXd> starts;
};

struct MultiStart {
    std::vector<StartOutcome> outcomes;  ///< by number
    Fit best;                            ///< of the lowest objective
    /// How many different minima the starts ended in: 1 where the posterior is one bump. Ends are
    /// the same within half a posterior sd of every parameter or 0.5 in ln posterior.
    int num_minimum = 0;
};

/// The starts that options ask for.
std::vector<Eigen::VectorXd> draw_starts(const std::vector<Parameter>& parameters,
                                         const MultiStartOptions& options);

/// Fits from every start. Outcomes in `earlier` with the same number and start are not computed
/// again; `keep` is called with each new one as it is there. The best one is fitted once more from
/// where it ended, so that resumed runs have its prediction, too. Throws Error(solve_failed) if no
/// start has a prediction.
MultiStart fit_from_starts(const DataProblem& problem, const MultiStartOptions& options,
                           const std::vector<StartOutcome>& earlier = {},
                           const std::function<void(const StartOutcome&)>& keep = {},
                           const ProgressSink& progress = {});

}  // namespace palpate

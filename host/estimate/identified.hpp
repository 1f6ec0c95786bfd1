// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "host/estimate/combination.hpp"
#include "host/estimate/fit.hpp"
#include "host/estimate/judgement.hpp"
#include "host/estimate/profile_search.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct IdentifyOptions {
    GaussNewtonOptions gauss_newton;  ///< of the searches along profiles
    /// A profile is followed where, at the quadratic interval's ends, it differs from the quadratic
    /// rise by more than this share of it. Nuisances have quadratic intervals, and all numbers have
    /// where this is infinite.
    double skewness_tolerance = 0.2;
    bool judges_far_ends = true;  ///< whether the far ends of ranges are predicted for verdicts
    /// [num_parameter] or empty: what will be added to the intervals, on the transformed scales.
    /// One whose own sd is smaller stays quadratic: how skew it is would not be seen.
    Eigen::VectorXd added_sd = {};
    ProfileGuide guide = {};  ///< that searches along profiles are led by; empty: none
    int jobs = 1;             ///< ends of profiles that are looked for at the same time
};

/// One parameter after a fit.
struct IdentifiedParameter {
    Parameter parameter;
    double value = 0;                      ///< on its own scale
    std::array<double, 2> interval{0, 0};  ///< 95 %, on its own scale
    double sd = 0;                         ///< Laplace, on the transformed scale
    /// With how many degrees of freedom `sd` is known (`degrees_of_freedom`): intervals are
    /// Student's.
    double degrees_of_freedom = 0;
    bool is_profiled = false;  ///< whether the interval is of the profile
    /// Whether an end of the interval is where the model could no longer be solved, or the end of
    /// what was allowed.
    std::array<bool, 2> is_cut{false, false};
    /// How far mesh and time steps have moved value and interval, and what is left unknown of that
    /// (sd, in the interval), on the transformed scale (`correct_for_discretisation`).
    double discretisation_shift = 0, discretisation_sd = 0;
    UnknownEvidence evidence;
    Judgement judgement;  ///< of `evidence` and the interval (`judge_parameter`)
    Index partner = -1;   ///< the parameter that correlates most with it; -1: alone
    double partner_correlation = 0;
};

/// How one block of data is met.
struct BlockFit {
    std::string name, kind, unit;
    Index num_row = 0;
    double rms = 0;                ///< of measured - predicted, in the unit
    double chi_squared = 0;        ///< r^T C^-1 r, about num_row if noise and discrepancy are right
    double chi_squared_noise = 0;  ///< sum of (r / sd)^2: without any discrepancy
    Discrepancy discrepancy;       ///< amplitude in the unit: the quality of the fit
    Index num_outlier = 0;         ///< rows that count less
    double effective_rows = 0;     ///< independent rows that would know a mean as well
};

/// Everything that is known after a fit.
struct Identified {
    std::vector<IdentifiedParameter> parameters;
    Eigen::MatrixXd covariance;   ///< Laplace, transformed scale [num_parameter, num_parameter]
    Eigen::MatrixXd correlation;  ///< of it
    /// Of the data over their noise with respect to parameters over their prior sd, largest first.
    Eigen::VectorXd singular_values;
    Combination best_known, weakest;
    std::vector<BlockFit> blocks;
    double log_evidence = 0;  ///< by Laplace, flat priors with density 1
    /// -2 ln likelihood + num_determined ln(effective_rows): the lower, the better.
    double bic = 0;
    /// How many parameters the data determine: the sum of 1 - sd^2 / prior sd^2.
    double num_determined = 0;
    double effective_rows = 0;  ///< of all blocks
    int num_prediction = 0;     ///< that profiles and far ends cost, guides apart
};

/// What a fit knows: Laplace covariance (J^T C^-1 J + P^-1)^-1 with the discrepancy and the Huber
/// weights in C, 95 % intervals by profile where the posterior is skewed, verdicts by the rules of
/// `recover` (method.md section 5), evidence. `progress` may throw to cancel.
Identified identify(const DataProblem& problem, const Fit& fit, const IdentifyOptions& options,
                    const ProgressSink& progress = {});

/// The verdict of a parameter by its evidence and the interval that it has now.
Judgement judge_parameter(const std::vector<Parameter>& parameters,
                          const IdentifiedParameter& found);

/// n_eff = 1^T R^-1 1 with R the correlation matrix of C: how many independent rows would know a
/// mean as well; between 1 and the number of rows.
double effective_rows(const BlockCovariance& covariance);

}  // namespace palpate

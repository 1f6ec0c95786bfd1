// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "host/estimate/data_problem.hpp"
#include "host/estimate/gauss_newton.hpp"
#include "host/estimate/learn_discrepancy.hpp"
#include "host/estimate/noise_model.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// How the most probable values are looked for.
enum class FitMethod : std::uint8_t {
    map,      ///< Gauss-Newton on columns
    simplex,  ///< Nelder and Mead without columns: what is usual in the field, for comparison
    bobyqa,   ///< quadratic interpolation in a trust region without columns
};

/// The words of files and pages: "map", "simplex", "bobyqa"; and back, which throws
/// Error(invalid_argument) naming the words that are allowed.
const char* name_of(FitMethod method);
FitMethod fit_method_of(std::string_view words);

struct FitOptions {
    FitMethod method = FitMethod::map;
    GaussNewtonOptions gauss_newton;
    NoiseOptions noise;
    DiscrepancyOptions discrepancy;
    int max_evaluations = 2000;  ///< of a simplex or bobyqa search
    /// Where to begin, [num_parameter] on the parameters' own scales; empty: the parameters'
    /// starts.
    Eigen::VectorXd start;
    /// A prediction of this problem, at the start or near it, that saves one, or of one that is
    /// nearly the same and has other values; may be null.
    std::shared_ptr<const Prediction> warm = {};
    std::vector<Index> held = {};  ///< parameters that stay at the start
    /// Whether the priors' medians and draws are tried where the start has no prediction.
    bool tries_other_starts = true;
};

/// The most probable values and what was learned of the noise.
struct Fit {
    Eigen::VectorXd values, transformed;  ///< [num_parameter]
    /// There, with columns; those of a place nearby where `keeps_columns_within` allowed it.
    std::shared_ptr<const Prediction> prediction;
    std::shared_ptr<const NoiseModel> noise;  ///< discrepancies and weights there
    NormalEquations equations;                ///< there
    /// How uncertain the discrepancies are (`discrepancy_covariances`), one for each block; empty
    /// if they were not learned.
    std::vector<Eigen::Matrix3d> discrepancy_covariance;
    double objective = 0;  ///< minus the log posterior, discrepancies' priors included
    FitMethod method = FitMethod::map;
    Ending ending = Ending::converged;
    bool is_settled = true;  ///< whether discrepancies no longer change with the values
    int num_round = 0;       ///< searches, one after each update of the discrepancies
    int num_step = 0;        ///< trials of all searches
    int num_prediction = 0, num_failed = 0;
    std::string start_note;  ///< which start was taken, if the first one had no prediction

    bool is_usable() const { return ending != Ending::too_many_steps && is_settled; }
};

/// One draw from the priors, within the hard ends, on the parameters' own scales [num_parameter].
/// Flat priors: sd 1 of a log or logit around the start, else the size of the start.
Eigen::VectorXd draw_from_priors(const std::vector<Parameter>& parameters, std::mt19937& random);

/// Where `quadratic_step` leads from a fit, on the parameters' own scales: the end of a search that
/// stopped before it, without another prediction. The fit's own values where that would gain more
/// than `most_gain` of ln posterior: so far no quadratic is believed. What `FitOptions::held` held
/// is free here.
Eigen::VectorXd quadratic_minimum(const std::vector<Parameter>& parameters, const Fit& found,
                                  double most_gain);

/// Most probable values of the parameters: searches with the discrepancies held, alternating with
/// `learn_discrepancies` at the linearisation there, until these hold still. The first search has
/// no discrepancy unless one is given in advance.
///
/// If the model cannot be solved at the start, the priors' medians and some draws from the priors
/// are tried; throws Error(solve_failed) with the first failure if none can. Throws
/// Error(invalid_argument) for parameters that make no sense. `progress` may throw to cancel.
Fit fit(const DataProblem& problem, const FitOptions& options, const ProgressSink& progress = {});

}  // namespace palpate

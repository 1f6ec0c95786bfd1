// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/estimate/data_problem.hpp"
#include "host/estimate/noise_model.hpp"
#include "host/estimate/quadratic_step.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Why a search ended.
enum class Ending : std::uint8_t {
    converged,       ///< nothing worth a step is left
    too_many_steps,  ///< its steps or evaluations are used up
    stalled,         ///< no step, however short, gains anything, though one should
};

/// The words of files and pages: "converged", "too many steps", "stalled".
const char* name_of(Ending ending);

struct GaussNewtonOptions {
    double max_change = usual_max_change;  ///< of a log or logit parameter in one step
    /// The search ends when the best step would gain less than this in ln posterior.
    double gain_tolerance = 0.01;
    /// Or less than this share of the misfit, for searches whose noise is not yet known.
    double gain_share = 0;
    /// A step that should gain less than this and ends within as much of where columns were made,
    /// in ln posterior, is solved without columns and keeps those (a chord step). Where one is
    /// rejected, columns are made. 0: none does.
    double keeps_columns_within = 0;
    int max_steps = 60;           ///< accepted and rejected ones
    double first_damping = 1e-3;  ///< lambda of the first step, in units of the curvature
};

/// Where a search begins.
struct GaussNewtonStart {
    Eigen::VectorXd values;                  ///< [num_parameter] on the parameters' own scales
    std::shared_ptr<const Prediction> warm;  ///< a prediction nearby, or null
    std::vector<Index> held;                 ///< that stay where they are, beside those that say so
};

/// One trial of a search, for its records.
struct GaussNewtonTrial {
    double objective = 0;       ///< F after it; infinite if the prediction failed
    double predicted_gain = 0;  ///< of F by the undamped step
    double damping = 0;
    bool accepted = false;
    std::string failure;  ///< why the prediction failed, or empty
};

struct GaussNewtonMinimum {
    Eigen::VectorXd values, transformed;  ///< [num_parameter]
    /// There, with columns; those of a place nearby where `keeps_columns_within` allowed it.
    std::shared_ptr<const Prediction> prediction;
    NormalEquations equations;  ///< there
    double objective = 0;       ///< F there, `minus_log_posterior`
    double predicted_gain = 0;  ///< what the best step would still gain
    Ending ending = Ending::converged;
    std::vector<GaussNewtonTrial> trials;
    int num_prediction = 0, num_failed = 0;
};

/// Minimum of F = minus the log posterior by Gauss-Newton steps with Levenberg-Marquardt damping,
///     (H + lambda diag H) d = -g,    H = J^T C^-1 J + P^-1,
/// on the transformed scale (Marquardt 1963; Madsen, Nielsen and Tingleff 2004, algorithm 3.16 for
/// lambda). A step is shortened where it changes a log or logit parameter by more than `max_change`
/// or one with a prior on its own scale by more than three of its sd; at hard ends parameters stop
/// and are let go when F falls inwards. A prediction that fails is a rejected step. The Huber
/// weights in `noise` are updated after each accepted step; its discrepancies are held. Six trials
/// that together gain less than `gain_tolerance` are the end, too.
/// Not converging is a result. Throws Error(solve_failed) if the prediction at the start fails;
/// `progress` may throw to cancel.
GaussNewtonMinimum minimise_gauss_newton(const DataProblem& problem, NoiseModel& noise,
                                         const GaussNewtonStart& start,
                                         const GaussNewtonOptions& options,
                                         const ProgressSink& progress = {});

}  // namespace palpate

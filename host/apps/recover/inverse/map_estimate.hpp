// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "host/apps/recover/inverse/linearised_problem.hpp"
#include "host/apps/recover/inverse/map_options.hpp"
#include "host/apps/recover/inverse/records.hpp"
#include "host/apps/recover/inverse/surface_noise.hpp"
#include "host/apps/recover/observations/surface_observations.hpp"
#include "host/estimate/posterior.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct MapEstimate {
    Eigen::VectorXd driven;                   ///< [3 num_driven] mm
    FrameMotion frame = FrameMotion::Zero();  ///< by which the target's alignment is off
    Eigen::VectorXd observed;                 ///< [3 num_observed] mm
    std::vector<Unknown> unknown;             ///< regions that were estimated
    Eigen::VectorXd theta;                    ///< ln E of them
    Eigen::MatrixXd covariance;               ///< of theta, Laplace approximation
    Eigen::VectorXd mesh_change_ln;  ///< of theta, for elements are not infinitely small; or empty
    std::vector<std::array<double, 2>> interval_kpa;  ///< 95 %, from the profile of F, as found
    std::vector<ProfileResult> profiles;
    Eigen::VectorXd seen_sd_ln;                      ///< see posterior.hpp, as the next two
    std::vector<std::array<bool, 2>> excluded_ends;  ///< [num unknown], softest, stiffest
    ScaledSensitivity sensitivity;
    std::shared_ptr<const WallPrior> walls;         ///< fitted; null: as they were given
    std::shared_ptr<const ResponseModel> response;  ///< with these; null as well
    /// The problem linearised at the estimate, for the uncertainty of whatever follows from the
    /// wall motion; valid as long as the response model and the walls' prior are.
    std::shared_ptr<const LinearisedProblem> posterior;
    NoiseLevel noise_level;
    std::shared_ptr<const SurfaceNoise> noise;  ///< as it was in the end; valid as the observations
    std::shared_ptr<const CountedRows> counted;  ///< those that the objective is over
    /// Minus the log posterior at the estimate, the wall motion integrated out, up to a constant
    /// that estimates of other models share if they hold this one's noise and rows.
    double objective = 0;
    std::vector<IterationRecord> records;
    Termination termination;
    /// Ends of searches that began elsewhere (method.md, 4.7), what uncertainty says of them alone.
    std::vector<std::shared_ptr<const MapEstimate>> others;
};

/// The most probable moduli and wall motion (method.md section 4): Gauss-Newton on the surface
/// distances; at each linearisation the moduli minimise the marginal objective F exactly
/// (LinearisedProblem), found by a coarse scan, then Newton; a line search on the nonlinear
/// objective guards every step. Not converging is not an error: see `termination`.
MapEstimate map_estimate(const ResponseModel& model, const WallPrior& walls,
                         const SurfaceObservations& observations,
                         const std::vector<Unknown>& unknowns, const MapOptions& options,
                         const ProgressSink& progress = {});

/// Searches of the same data whose walls begin otherwise (`FirstWalls`), at the same time, that
/// have converged elsewhere than where `found` has. Of the calls of `progress` this thread makes
/// all.
std::vector<std::shared_ptr<const MapEstimate>> other_ends(
    const MapEstimate& found, const ResponseModel& model, const WallPrior& walls,
    const SurfaceObservations& observations, const std::vector<Unknown>& unknowns,
    const MapOptions& options, const ProgressSink& progress = {});

/// The same, started at an earlier estimate from the same observations with another model, whose
/// counted rows and their noise are held: the objectives of the two can be compared.
MapEstimate map_estimate_from(const MapEstimate& earlier, const ResponseModel& model,
                              const WallPrior& walls, const SurfaceObservations& observations,
                              const std::vector<Unknown>& unknowns, const MapOptions& options,
                              const ProgressSink& progress = {});

/// The same, started at an earlier estimate from the same observations with a model that differs a
/// little; nothing is held.
MapEstimate map_estimate_near(const MapEstimate& earlier, const ResponseModel& model,
                              const WallPrior& walls, const SurfaceObservations& observations,
                              const std::vector<Unknown>& unknowns, const MapOptions& options,
                              const ProgressSink& progress = {});

/// Covariance, profiles and all that is judged by from the inverse problem `problem`, linearised at
/// the estimate or near it. `progress` is only asked whether to cancel.
void take_uncertainty(const Objective& problem, const MapOptions& options, MapEstimate& estimate,
                      const ProgressSink& progress = {});

}  // namespace palpate

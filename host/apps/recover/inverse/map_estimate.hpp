// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "host/apps/recover/inverse/marginal.hpp"
#include "host/apps/recover/inverse/records.hpp"
#include "host/apps/recover/inverse/surface_noise.hpp"
#include "host/apps/recover/objectives/surface_observations.hpp"
#include "host/estimate/posterior.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// No contours of two images that are further off together (mm) are looked for.
constexpr double most_contour_mm = 1.5;

struct MapOptions {
    int max_iterations = 40;
    // Converged: three steps in a row of which none would change ln E by more than the first times
    // its posterior standard deviation, or the objective (a log posterior) by more than the second
    // times the number of surface points.
    double modulus_tolerance_sd = 0.1;
    double objective_tolerance_per_row = 1e-3;
    double smallest_kpa = 0.1, largest_kpa = 1e5;  ///< the search stays between these
    /// If above 1: every modulus stays within this factor of where the search starts.
    double reach = 0;
    double start_kpa = 0;        ///< of all unknown moduli; 0: the prior's median
    bool estimate_noise = true;  ///< find what is not given of the noise from the observed surface
    /// Standard deviation (mm) of the error of both images' contours together, which neighbouring
    /// points share. Empty: found. Given, the scale of sigma_n is found instead.
    std::optional<double> contour_mm;
    /// What is expected of the walls' motion is fitted to their own distances (fit_walls).
    bool fit_walls = true;
    double smallest_noise_scale = 1;  ///< lower for surfaces without voxels
    /// The size of the noise and the terraces are held from here on, so that the steps can settle.
    int noise_iterations = 6;
};

struct MapEstimate {
    Eigen::VectorXd driven;                           ///< [3 num_driven] mm
    FrameMotion frame = FrameMotion::Zero();          ///< by which the target's alignment is off
    Eigen::VectorXd observed;                         ///< [3 num_observed] mm
    std::vector<Unknown> unknown;                     ///< regions that were estimated
    Eigen::VectorXd theta;                            ///< ln E of them
    Eigen::MatrixXd covariance;                       ///< of theta, Laplace approximation
    std::vector<std::array<double, 2>> interval_kpa;  ///< 95 %, from the profile of F
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
};

/// The most probable moduli and wall motion (method.md section 3): Gauss-Newton on the surface
/// distances; at each linearisation the moduli minimise the marginal objective F exactly
/// (LinearisedProblem), found by a coarse scan, then Newton; a line search on the nonlinear
/// objective guards every step. Not converging is not an error: see `termination`.
MapEstimate map_estimate(const ResponseModel& model, const WallPrior& walls,
                         const SurfaceObservations& observations,
                         const std::vector<Unknown>& unknowns, const MapOptions& options,
                         const ProgressSink& progress = {});

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

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/apps/recover/inverse/map_estimate.hpp"
#include "host/apps/recover/inverse/model_error.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/apps/recover/pipeline/recover_options.hpp"
#include "solver/equilibrium/newton.hpp"

namespace palpate {

struct FiniteStrainOptions {
    int max_rounds = 12;  ///< linearisations at most
    /// Converged: a round changed no ln E by more than this part of its standard deviation, that of
    /// the model (model_error.hpp) included, or by 1e-3 if that is larger, and
    double modulus_tolerance_sd = 0.1;
    double model_sd_ln = palpate::model_sd_ln;
    /// the equilibrium lies this close to what the linearised model said, root mean square, mm.
    double displacement_tolerance_mm = 0.03;
    /// What tangents may leave out of motions drawn from the prior, root mean square: a third of
    /// the noise, but no more than 0.1 and no less than this.
    double tangent_tolerance_mm = 0.02;
    MapOptions search;
    LinearSolverOptions solver;
};

/// What a search at large deformation finds.
struct FiniteStrainEstimate {
    MapEstimate first;  ///< with linear elasticity: where the rounds began; without posterior
    /// Linearised at the equilibrium before the last round; the posterior of `estimate` points to
    /// it.
    std::shared_ptr<const ResponseModel> response;
    MapEstimate estimate;
    std::shared_ptr<const SolidAssembly> solid;  ///< with the estimated moduli
    Equilibrium state;                           ///< of `solid`, with the estimated wall motion
    int rounds = 0;                              ///< linearisations
    double gap_mm = 0;  ///< between equilibrium and linearised model, root mean square
    LinearSolverInfo solver;
    ElementLoopInfo loops;  ///< of the equilibria
};

/// The most probable moduli and wall motion of a body at large deformation: linear elasticity
/// first, then round by round the equilibrium at the last estimate, the mechanics linearised there
/// (`tangent_response`), and the most probable moduli and motion of these, until neither changes.
/// Where an equilibrium cannot be reached at once, the round starts from the nearest one that can.
/// Throws Error(solve_failed) if none is reached in the end.
FiniteStrainEstimate search_finite_strain(const Mechanics& rest, const TissueLaw& law,
                                          const SurfaceObservations& observations,
                                          const FiniteStrainOptions& options,
                                          const ProgressSink& progress = {});

/// Throws Error(invalid_argument) for options that do not go with the law of the tissue.
void check_tissue_law(const RecoverOptions& options);

}  // namespace palpate

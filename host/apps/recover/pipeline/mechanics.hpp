// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/recover/inverse/linearised_problem.hpp"
#include "host/apps/recover/inverse/response_model.hpp"
#include "host/apps/recover/inverse/wall_prior.hpp"
#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/apps/recover/pipeline/stage_timer.hpp"
#include "solver/condense/condensation.hpp"

namespace palpate {

/// Everything about a meshed reference that no target changes: the forward model, condensed
/// exactly for every modulus, the prior of the walls' motion, and what of both the search needs.
struct Mechanics {
    RecoveryModel recovery;
    WallPrior walls;
    ResponseModel response;
    std::vector<Unknown> unknowns;  ///< ln E of the unknown moduli that have any influence
    CondensationSummary condensation;
};

struct MechanicsOptions {
    ResponseOptions response;
};

/// What is expected of the driven walls' motion, with their places and normals.
WallExpectation wall_expectation(const RecoveryModel& recovery, const PriorSettings& prior);

/// From node sets to a model that answers for any modulus. Unknown moduli have their prior's median
/// in `recovery.model`.
Mechanics make_mechanics(RecoveryModel recovery, const PriorSettings& prior,
                         const LinearSolverOptions& solver, const MechanicsOptions& options,
                         StageTimer& timer, const ProgressSink& progress = {});

/// From a mesh in memory to a model that answers for any modulus: node sets, condensation, response
/// model. Throws what `build_model` and `condense` throw.
Mechanics make_mechanics(const BodyMesh& mesh, const Settings& settings,
                         const LinearSolverOptions& solver, const MechanicsOptions& options,
                         StageTimer& timer, const ProgressSink& progress = {});

}  // namespace palpate

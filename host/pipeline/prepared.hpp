// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/objectives/surface_observations.hpp"
#include "host/pipeline/finish.hpp"
#include "host/pipeline/mechanics.hpp"
#include "host/pipeline/observed_target.hpp"
#include "host/pipeline/stages.hpp"
#include "host/pipeline/states.hpp"

namespace palpate {

/// The reference with all that is done once, however many targets there are.
struct PreparedReference {
    ReferenceState reference;
    RegionMesh mesh;
    MesherSummary mesher;
    std::vector<DistanceMap> maps;  ///< of the matched organs
    Mechanics mechanics;
    std::shared_ptr<FullSolver> full_solver;  ///< of `mechanics.recovery.model`
};

/// Meshes the reference (or reads the ready mesh) and condenses it.
PreparedReference prepare_reference(ReferenceState reference, const RecoverOptions& options,
                                    StageTimer& timer, const ProgressSink& progress);

/// The same from a mesh in memory.
PreparedReference prepare_mesh(ReferenceState reference, RegionMesh mesh, MesherSummary mesher,
                               std::vector<DistanceMap> maps, const RecoverOptions& options,
                               StageTimer& timer, const ProgressSink& progress);

/// Sets up the solver of the whole model, in the background.
std::shared_ptr<FullSolver> start_full_solver(const RecoveryModel& recovery,
                                              const LinearSolverOptions& options);

/// Moduli, wall motion, field and forces for one target, from `start_target_shapes` of it.
Recovered search_target(const PreparedReference& prepared, const TargetState& target,
                        std::future<TargetShapes> shapes, const RecoverOptions& options,
                        StageTimer& timer, const ProgressSink& progress);

/// The same from what is observed, for any shape of the target: fills `found.estimate`, field and
/// forces. `found.recovery` is that of `mechanics`.
void search_model(Recovered& found, const Mechanics& mechanics, FullSolver& full_solver,
                  const SurfaceObservations& observations, const RecoverOptions& options,
                  StageTimer& timer, const ProgressSink& progress);

}  // namespace palpate

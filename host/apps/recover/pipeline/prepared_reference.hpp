// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "host/apps/recover/pipeline/finer_mesh.hpp"
#include "host/apps/recover/pipeline/full_solver.hpp"
#include "host/apps/recover/pipeline/mechanics.hpp"
#include "host/apps/recover/pipeline/reference_state.hpp"
#include "host/apps/recover/pipeline/stage_timer.hpp"

namespace palpate {

/// The reference with all that is done once, however many targets there are.
struct PreparedReference {
    ReferenceState reference;
    BodyMesh mesh;
    MesherSummary mesher;
    std::vector<DistanceMap> maps;  ///< of the matched organs
    Mechanics mechanics;
    std::shared_ptr<FullSolver> full_solver;  ///< of `mechanics.recovery.model`
    std::shared_ptr<FinerMesh> finer_mesh;    ///< of `mesh`, or null
};

/// Meshes the reference (or reads the ready mesh) and condenses it.
PreparedReference prepare_reference(ReferenceState reference, const RecoverOptions& options,
                                    StageTimer& timer, const ProgressSink& progress);

/// The same from a mesh in memory.
PreparedReference prepare_reference(ReferenceState reference, BodyMesh mesh, MesherSummary mesher,
                                    std::vector<DistanceMap> maps, const RecoverOptions& options,
                                    StageTimer& timer, const ProgressSink& progress);

/// The finer mesh of a reference of tet4; null where none is counted
/// (method.md, 4.6): other elements, more than 30,000 nodes, another method or law than the usual
/// ones, unknown Poisson's ratios.
std::shared_ptr<FinerMesh> make_finer_mesh(const BodyMesh& mesh, const RecoverOptions& options);

/// Sets up the solver of the whole model, in the background; at large deformation, which has no use
/// for it, when it is asked for.
std::shared_ptr<FullSolver> start_full_solver(const RecoveryModel& recovery,
                                              const RecoverOptions& options);

}  // namespace palpate

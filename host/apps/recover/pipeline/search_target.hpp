// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>

#include "host/apps/recover/observations/surface_observations.hpp"
#include "host/apps/recover/pipeline/observed_target.hpp"
#include "host/apps/recover/pipeline/prepared_reference.hpp"
#include "host/apps/recover/pipeline/recovered.hpp"

namespace palpate {

/// Moduli, wall motion, field and forces for one target, from `start_target_shapes` of it.
Recovered search_target(const PreparedReference& prepared, const TargetState& target,
                        std::future<TargetShapes> shapes, const RecoverOptions& options,
                        StageTimer& timer, const ProgressSink& progress);

/// The same from what is observed, for any shape of the target: fills `found.estimate`, field and
/// forces. `found.recovery` is that of `mechanics`; `finer_mesh` may be null.
void search_model(Recovered& found, const Mechanics& mechanics, FullSolver& full_solver,
                  const FinerMesh* finer_mesh, const SurfaceObservations& observations,
                  const RecoverOptions& options, StageTimer& timer, const ProgressSink& progress);

}  // namespace palpate

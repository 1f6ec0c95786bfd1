// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "host/inverse/map_estimate.hpp"
#include "host/meshing/mesher.hpp"
#include "host/modelling/alignment.hpp"
#include "host/modelling/settings.hpp"
#include "host/result/recovery_result.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

struct RecoverOptions {
    std::filesystem::path reference, target;  ///< label volumes
    Settings settings;
    MesherOptions mesher;
    std::filesystem::path mesh;  ///< ready mesh (.vtu with `region` labels) or empty
    AlignMethod align = AlignMethod::automatic;  ///< fixed organs if there are any, else centroids
    std::filesystem::path
        initial_transform;  ///< rigid ITK transform, reference to target, or empty
    LinearSolverOptions solver;
    MapOptions search;
};

/// The main job: two segmentations in, moduli, forces, field and error bars out (style.md section
/// 1). Throws Error with the codes of each station; not converging is reported in the result.
RecoveryResult recover(const RecoverOptions& options, const ProgressSink& progress = {});

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/apps/recover/inverse/map_estimate.hpp"
#include "host/apps/recover/inverse/nested_lbfgs.hpp"
#include "host/apps/recover/modelling/alignment.hpp"
#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/apps/recover/pipeline/mechanics.hpp"
#include "host/apps/recover/result/landmark.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "solver/elements/element.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// How moduli and wall motion are searched.
enum class SearchMethod {
    map,           ///< the most probable ones, with intervals
    nested_lbfgs,  ///< the published baseline, without intervals
};

constexpr int usual_max_rounds = 12;

struct RecoverOptions {
    Settings settings;
    MesherOptions mesher;
    /// tet4 or tet10; `mesher.num_nodes` counts mid-side nodes, too. A ready mesh of tet10 stays
    /// so.
    ElementType element = ElementType::tet4;
    std::filesystem::path mesh;  ///< ready mesh (.vtu with `region` labels) or empty
    AlignMethod align = AlignMethod::automatic;  ///< fixed organs if there are any, else centroids
    std::filesystem::path
        initial_transform;  ///< rigid ITK transform, reference to target, or empty
    LinearSolverOptions solver;
    MechanicsOptions mechanics;
    SearchMethod method = SearchMethod::map;
    TissueLaw law;
    int max_rounds = usual_max_rounds;  ///< linearisations at large deformation at most
    MapOptions search;
    /// Search for several moduli from other places, too, and tell of all answers (method.md, 4.7).
    bool looks_elsewhere = true;
    NestedOptions nested;                ///< for `nested_lbfgs`
    std::vector<Landmark> landmarks;     ///< measured at the end, not used by the search
    std::filesystem::path save_reduced;  ///< file for the mesh and the reduced model, or empty
    /// Such a file, used instead of meshing and condensing, or empty. `mesh` and `mesher` are then
    /// not read. Another reference or other settings than it was saved for: Error(input_unusable).
    std::filesystem::path load_reduced;
};

}  // namespace palpate

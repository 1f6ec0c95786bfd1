// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/recover/inverse/map_estimate.hpp"
#include "host/apps/recover/modelling/alignment.hpp"
#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/apps/recover/pipeline/finite_strain.hpp"
#include "host/apps/recover/pipeline/poisson_ratios.hpp"
#include "host/geometry/surfaces/target_shape.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Everything the search leaves behind, before it is put into words and pictures.
struct Recovered {
    AlignmentResult alignment;
    MesherSummary mesher;
    RecoveryModel recovery;
    std::vector<std::shared_ptr<const TargetShape>> target;  ///< as in ObservedShapes
    MapEstimate estimate;
    /// What the search added to the answers of the mesh, for its elements are not infinitely small
    /// [3 num_observed] mm; empty: nothing.
    Eigen::VectorXd mesh_change;
    std::optional<PoissonEstimate> poisson;  ///< if a ratio was unknown
    /// At large deformation; its `estimate` has moved to the one above.
    std::optional<FiniteStrainEstimate> finite;
    TissueLaw law;
    // Filled by `solve_full_model` or `take_equilibrium`:
    Eigen::VectorXd displacement;    ///< [3 num_nodes] mm
    Eigen::VectorXd force;           ///< [3 num_nodes] mN, reactions at prescribed nodes
    std::vector<Vec3> resultant_sd;  ///< [surfaces] mN, of the force on each driven organ
    double relative_residual = 0;
    LinearSolverInfo solver;
    std::vector<std::string> warnings;
};

}  // namespace palpate

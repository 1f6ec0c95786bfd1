// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/phantom/wall_motion.hpp"
#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// The body as linear tetrahedra on the same nodes: tet4 as they are, each tet10 as eight.
RegionMesh linear_pieces_of(const BodyMesh& body);

/// Which nodes of a mesh lie on the surface of a region (1) and which do not (0), [num_nodes].
std::vector<std::uint8_t> nodes_on_region(const RegionMesh& mesh, Index region);

/// The forward problem of a phantom: dofs on the walls, the box and the bones are prescribed.
struct WallProblem {
    Model model;
    Columns prescribed_mm;  ///< [num_dofs, loads] the walls' motion, 0 at all other dofs
};

/// Box and bones are at rest; where a wall meets them it rests too.
///   materials  by region number
WallProblem make_wall_problem(const RegionMesh& mesh, const std::vector<LinearElastic>& materials,
                              const std::vector<WallMotion>& motions);

struct Deformation {
    std::vector<Vec3> displacement;  ///< [num_nodes] mm, load scale included
    std::vector<Vec3> force;         ///< [num_nodes] mN, internal: 0 at nodes that may move
    double load_scale = 1;           ///< factor on the wall motions, 1 where no element suffers
    double smallest_jacobian = 1;    ///< smallest det(I + grad u) of all tets
    double relative_residual = 0;    ///< of the solve
};

/// Solves for equilibrium on the body's elements, with the walls' motion prescribed and bones and
/// box fixed, times `load_factor`, with the load scaled down until det(I + grad u) > 0.2 in every
/// one of `linear_pieces_of`.
///   materials  by region number
///   loads      of each the motions; all move the same walls
/// Returns a deformation for each load. Throws Error(solve_failed) if the solver misses its
/// tolerance, or if no equilibrium at large deformation is found.
std::vector<Deformation> deform_by_walls(const BodyMesh& body,
                                         const std::vector<LinearElastic>& materials,
                                         const std::vector<std::vector<WallMotion>>& loads,
                                         double load_factor, const TissueLaw& law,
                                         const LinearSolverOptions& options,
                                         const ProgressSink& progress);

}  // namespace palpate

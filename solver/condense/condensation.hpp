// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/linear/linear_solver.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// Exact condensation of one region onto the nodes it shares with the observed and the driven sets,
/// at unit modulus: S = K_bb - K_bi K_ii^-1 K_ib (method of static condensation, Guyan 1965, exact
/// here because no inertia is involved). Because K = sum_r E_r K_r, S(E) = sum_r E_r S_r holds for
/// every E. Only the columns of the observed nodes are formed.
struct CondensedRegion {
    Index region = 0;
    std::vector<Index> observed;        ///< positions in the observed node list, ascending
    std::vector<Index> driven;          ///< positions in the driven node list, ascending
    Eigen::MatrixXd observed_observed;  ///< [3 |observed|, 3 |observed|], mN/mm per kPa, symmetric
    Eigen::MatrixXd observed_driven;    ///< [3 |observed|, 3 |driven|]
};

struct CondensationSummary {
    LinearSolverSummary linear;  ///< summed over the regions
    LinearSolverInfo solver;     ///< of the region with the most columns
    Index columns = 0;           ///< right-hand sides solved
    double seconds = 0;
};

/// The condensed stiffness of every region of a model that touches an observed node, for elements
/// of any type and laws of the registry with the parameters `stiffness_kpa`, to which their energy
/// is proportional, and `poisson_ratio`.
///   observed, driven   node numbers, disjoint. Nodes in neither list whose dofs are not prescribed
///   in `model` are interior. Prescribed dofs have zero displacement.
/// Each region's interior problem K_ii x = -K_ib is solved on the region's own sub-mesh with the
/// given linear solver, which is told their number, all columns in batches: the adjoint sensitivity
/// columns of the inverse problem. Throws Error(solve_failed) if a column misses the tolerance.
std::vector<CondensedRegion> condense(const SolidModel& model, const std::vector<Index>& observed,
                                      const std::vector<Index>& driven,
                                      const LinearSolverOptions& options,
                                      CondensationSummary* summary = nullptr,
                                      const ProgressSink& progress = {});

/// What condensation leaves of one region at unit modulus, for m motions V of the observed nodes
/// and k motions D of the driven ones.
struct CondensedMotions {
    Index region = 0;
    Eigen::MatrixXd stiffness;  ///< V^T S_oo V [m, m], mN mm per kPa, symmetric
    Eigen::MatrixXd coupling;   ///< V^T S_od D [m, k]
};

/// A body linearised at an equilibrium u* of its laws, which it is for some moduli E*: forces and
/// tangent are sums over the regions, f = sum_r E_r f_r and K = sum_r E_r K_r(u*), so for other
/// moduli and wall motions, to first order,
///   sum_r E_r (g_r + S_r,oo (u_o - u_o*) + S_r,od (u_d - u_d*)) = 0
/// with g_r the forces of region r at the observed nodes (`region_forces`). At interior nodes each
/// region alone is in equilibrium, whatever its modulus. One solve a motion V, directly on the
/// host.
///   displacement                u*, [3 num_nodes] mm
///   observed_motions            V [3 |observed|, m]
///   driven_motions              D [3 |driven|, k]
/// Throws Error(solve_failed) also where a region is not stable.
std::vector<CondensedMotions> condense_at(
    const Eigen::VectorXd& displacement, const SolidModel& model,
    const std::vector<Index>& observed, const std::vector<Index>& driven,
    const Eigen::MatrixXd& observed_motions, const Eigen::MatrixXd& driven_motions,
    const LinearSolverOptions& options, CondensationSummary* summary = nullptr,
    const ProgressSink& progress = {});

/// Internal forces of one region at unit modulus.
struct RegionForce {
    Index region = 0;
    Eigen::VectorXd force;  ///< g_r [3 |observed|] mN per kPa
};

/// The g_r of `condense_at`, for the same regions in the same order.
std::vector<RegionForce> region_forces(const Eigen::VectorXd& displacement, const SolidModel& model,
                                       const std::vector<Index>& observed,
                                       const std::vector<Index>& driven);

}  // namespace palpate

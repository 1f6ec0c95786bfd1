// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solver/equilibrium/time_steps.hpp"

namespace palpate {

/// Derivatives of a scalar J of the displacements at all times of a load history. A load that stays
/// for several times has a derivative at each of them.
struct HistoryGradient {
    std::vector<std::vector<double>> parameters;  ///< [materials][parameters]
    /// [materials][terms] by amplitude and by time_s.
    std::vector<std::vector<RelaxationTerm>> relaxation;
    std::vector<Eigen::VectorXd> force;              ///< [times][3 num_nodes] per mN
    std::vector<Eigen::VectorXd> displacement;       ///< [times][3 num_nodes] per mm, total
    std::vector<std::vector<Vec3>> obstacle_motion;  ///< [times][contacts] per mm
    std::vector<std::vector<double>> pressure_kpa;   ///< [times][model.pressures] per kPa
};

/// The discrete adjoint of `solve_history`, exact for its time steps: backwards in time, one solve
/// with each step's tangent, what relaxation and friction remember handed from step to step
/// (Michaleris, Tortorelli and Vidal 1994). Friction's limits follow the pressure and
/// following pressures the surface, so those tangents are not symmetric.
///   times   as given to `solve_history`
///   states  what it returned, all converged
///   dj_du   [times][3 num_nodes] partial derivatives of J; an empty one is zero
///   direct_library   of the factorisation, see `make_sparse_factor`
/// Remembers 9 numbers per point, term and time. Throws Error(invalid_argument) for wrong sizes and
/// states that did not converge, Error(solve_failed) if a tangent is not positive definite.
HistoryGradient history_gradient(const SolidModel& model, const std::vector<LoadTime>& times,
                                 const std::vector<Equilibrium>& states,
                                 const std::vector<Eigen::VectorXd>& dj_du,
                                 const std::string& direct_library = "",
                                 const ProgressSink& progress = {});

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "solver/equilibrium/newton.hpp"

namespace palpate {

/// The loads at one time; between two times they change linearly. At time 0 the body is at rest
/// and without load.
struct LoadTime {
    double time_s = 0;
    SolidLoads loads;
};

/// Sees each state of a history with the assembly that it is an equilibrium of.
using TimeObserver = std::function<void(const SolidAssembly&, const Equilibrium&)>;

/// Throws Error(invalid_argument) for times that do not ascend from above 0.
void check_times(const std::vector<LoadTime>& times);

/// Quasi-static equilibrium at each of the times, ascending from above 0. With the reduced
/// relaxation function G(t) = 1 + sum_k C_k exp(-t / tau_k) of quasi-linear viscoelasticity (Fung
/// 1993, section 7.6) the second Piola stress is that of the law plus one history per term,
///   h_k' = exp(-x) h_k + c_k (S' - S),   x = dt / tau_k,   c_k = C_k (1 - exp(-x)) / x,
/// exact where S changes linearly in time (Taylor, Pister and Goudreau 1970). S is the law's stress
/// or its isochoric part, as `SolidMaterial::relaxation_of` says; for instantaneous moduli G is
/// divided by 1 + sum C_k. Stops after the first
/// time whose equilibrium is not reached. `guesses` are displacements [3 num_nodes] mm near those
/// at the first of the times, as of a history with nearly the same numbers: then Newton's method is
/// tried from there with the factor of the time before. Throws as `solve_equilibrium` does, and
/// Error(invalid_argument) for times that do not ascend.
std::vector<Equilibrium> solve_history(const SolidModel& model, const std::vector<LoadTime>& times,
                                       const EquilibriumOptions& options,
                                       const ProgressSink& progress = {},
                                       const TimeObserver& observer = {},
                                       const std::vector<Eigen::VectorXd>& guesses = {});

}  // namespace palpate

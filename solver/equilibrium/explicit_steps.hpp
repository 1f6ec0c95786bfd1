// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "solver/equilibrium/time_steps.hpp"

namespace palpate {

struct ExplicitOptions {
    double density_kg_per_m3 = 1000;
    double damping_per_s = 0;  ///< of all motion: the force -damping mass velocity
    double safety = 0.8;       ///< of the longest stable step, between 0 and 1
    double most_steps = 1e8;   ///< more are refused before the first
};

/// A moment of a motion.
struct DynamicState {
    double time_s = 0;
    Eigen::VectorXd displacement;  ///< [3 num_nodes] mm
    Eigen::VectorXd velocity;      ///< [3 num_nodes] mm/s, half a step before
    /// [3 num_nodes] mN: the forces that hold prescribed dofs, but for the inertia of their own
    /// nodes; zero elsewhere.
    Eigen::VectorXd reaction;
    double stored_energy = 0;   ///< mN mm, of matter and obstacles
    double kinetic_energy = 0;  ///< mN mm
    ContactState contact;
};

/// Sees each moment of a motion with the assembly that its forces are of.
using MotionObserver = std::function<void(const SolidAssembly&, const DynamicState&)>;

struct ExplicitHistory {
    std::vector<DynamicState> states;  ///< at the times that were reached
    bool is_complete = false;
    std::string message;
    double num_steps = 0;
    double longest_step_s = 0;
};

/// Motion from rest under loads that change linearly between the times, by explicit central
/// differences with a lumped mass (Belytschko, Liu and Moran 2000, section 6.2):
///   v' = ((1 - d/2) v + dt M^-1 (force - f(u))) / (1 + d/2),   u' = u + dt v',   d = damping dt
/// and prescribed dofs as told. Steps are `safety` times 2 / omega, omega^2 the largest eigenvalue
/// of M^-1 K at the last of the times that was passed (power iteration) plus what obstacles may
/// add. Relaxation and friction as in `solve_history`, with these steps. A motion that inverts
/// matter ends there, with a message. Throws as `solve_history` does, and Error(invalid_argument)
/// for options out of range and for more than `most_steps`.
ExplicitHistory solve_explicit(const SolidModel& model, const std::vector<LoadTime>& times,
                               const ExplicitOptions& options, const ProgressSink& progress = {},
                               const MotionObserver& observer = {});

}  // namespace palpate

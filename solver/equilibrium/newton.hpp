// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "solver/base/log.hpp"
#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/equilibrium/tangent_solve.hpp"

namespace palpate {

/// What a SolidModel is exposed to at full load.
struct SolidLoads {
    Eigen::VectorXd displacement;  ///< [3 num_nodes] mm at prescribed dofs, ignored elsewhere
    Eigen::VectorXd force;         ///< [3 num_nodes] mN, of constant direction
    /// [contacts] mm from where the model has the obstacles; empty: they rest.
    std::vector<Vec3> obstacle_motion = {};
    /// [model.pressures] kPa, against the outward normal of the deformed surface; empty: none.
    std::vector<double> pressure_kpa = {};
};

/// Throws Error(invalid_argument) for sizes that do not fit the model and numbers not finite.
void check_loads(const SolidModel& model, const SolidLoads& loads);

struct EquilibriumOptions {
    /// Of the residual at free dofs, against the norm of the internal forces or of the applied
    /// ones, whichever is larger.
    double relative_tolerance = 1e-9;
    int max_newton_steps = 60;    ///< per load step
    double first_step = 1.0;      ///< part of the load that is tried first
    double smallest_step = 1e-3;  ///< below it the solve gives up
    MatrixSolverOptions linear;   ///< how the tangent is solved with
    ElementLoopOptions loops;     ///< of assemblies that are made on the way (`solve_history`)
};

/// One Newton step, for tables and plots.
struct NewtonRecord {
    double load = 0;               ///< part of the full load
    double relative_residual = 0;  ///< before the step
    double step_length = 0;        ///< that the line search took; 0 at the end of a load step
};

struct Equilibrium {
    Eigen::VectorXd displacement;  ///< [3 num_nodes] mm
    ContactState contact;          ///< what the obstacles do
    /// [3 num_nodes] mN: the forces that hold prescribed dofs, zero elsewhere.
    Eigen::VectorXd reaction;
    double energy = 0;  ///< stored, mN mm
    double load = 0;    ///< part of the full load that was reached; 1 if converged
    double relative_residual = 0;
    bool converged = false;
    std::string message;
    std::vector<NewtonRecord> records;
    /// What was solved with, for gradients (`solid_gradient`); valid as long as the assembly is.
    std::shared_ptr<TangentSolve> tangent;
    /// Of a history with relaxation while its observer sees it: `SolidAssembly::relaxing_stress`.
    std::vector<Tensor3<double>> relaxing_stress;
};

/// Where a load path begins: an equilibrium under these loads. Empty: at rest, without load.
struct EquilibriumStart {
    Eigen::VectorXd displacement;            ///< [3 num_nodes] mm
    Eigen::VectorXd force;                   ///< [3 num_nodes] mN
    std::vector<Vec3> obstacle_motion = {};  ///< [contacts] mm
    std::vector<Vec3> friction = {};         ///< [contact points] kPa, of `ContactState`
    std::vector<double> pressure_kpa = {};   ///< [model.pressures]
    /// Nearly the equilibrium at full load [3 num_nodes] mm: Newton's method is tried from there
    /// before it follows the path. Empty: it is not.
    Eigen::VectorXd guess = {};
    /// Of an earlier solve on the same assembly: its factor serves as long as it is near enough.
    std::shared_ptr<TangentSolve> tangent = {};
};

/// Static equilibrium f(u) = force at free dofs, u = displacement at prescribed ones, by Newton's
/// method on the tangent. The prescribed dofs move first and the others
/// as the tangent says; then a line search keeps matter from inverting, and the total energy
/// (stored less the work of the forces) from growing unless that halves the residual. The work of
/// following pressures is that along the step, so that they need no potential. Where the symmetric
/// half of the tangent is not positive definite it is shifted until it is. Friction follows from
/// the slip between start and end, whatever load steps lie between; its limits are held while
/// forces are balanced and renewed until both agree. A load step that fails is halved, one that
/// goes well is followed by a longer one. Not converging is reported in the result, which then
/// holds the last equilibrium. Throws Error(invalid_argument) for loads of the wrong size or not
/// finite, and for options out of range.
Equilibrium solve_equilibrium(const SolidAssembly& solid, const SolidLoads& loads,
                              const EquilibriumOptions& options, const EquilibriumStart& start = {},
                              const ProgressSink& progress = {});

}  // namespace palpate

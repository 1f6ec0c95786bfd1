// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/observations/surface_observations.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// Phi and what it depends on, at one set of forces.
struct NestedState {
    double value_mm2 = 0;            ///< Phi
    Eigen::VectorXd displacement;    ///< [3 num_nodes] mm
    Eigen::VectorXd gradient;        ///< [3 num_nodes] dPhi/du, mm
    Eigen::VectorXd force_gradient;  ///< [3 num_driven] dPhi/df_d, mm^2/mN
};

/// The published objective (method.md section 4): Phi(E, f) = 1/2 sum_k r_k(u)^2, K(E) u = f, with
/// the distances r_k of every surface point to its target, not weighted by their noise, no prior.
/// Here driven nodes are free and carry unknown forces f_d; only the fixed nodes are held.
/// Gradients come from one adjoint solve; K is factorised once per set of moduli.
class NestedObjective {
public:
    /// Keeps references to both. `direct_library` as in LinearSolverOptions.
    /// Throws Error(input_unusable) if nothing is fixed: the free model could float,
    /// Error(invalid_argument) for other elements than tet4.
    NestedObjective(const RecoveryModel& recovery, const SurfaceObservations& observations,
                    const std::string& direct_library = {});

    /// Unknown regions that an observed node touches, ascending: theta holds ln E of these.
    const std::vector<Index>& unknown() const { return unknown_; }
    Index num_forces() const { return 3 * static_cast<Index>(recovery_.driven.size()); }
    long num_solves() const { return num_solves_; }  ///< of K x = b, one column each

    /// theta: ln E of `unknown()`, E in kPa. One factorisation.
    void set_moduli(const Eigen::VectorXd& theta);
    /// [3 num_driven] mN: the reactions when each driven node is moved to its closest target point,
    /// x - d grad d, at these moduli.
    Eigen::VectorXd starting_force();
    /// force: [3 num_driven] mN. Two solves.
    NestedState evaluate(const Eigen::VectorXd& force);
    /// dPhi/dtheta with the forces held: E_r times -lambda^T K_r u. One solve.
    Eigen::VectorXd modulus_gradient(const NestedState& state);
    /// Second derivative of Phi along a force direction [3 num_driven], without the curvature of
    /// the surfaces: |J (du/df) direction|^2. One solve.
    double curvature(const NestedState& state, const Eigen::VectorXd& direction);

private:
    ObservedState observe(const Eigen::VectorXd& displacement) const;
    Eigen::VectorXd driven_to_nodes(const Eigen::VectorXd& driven) const;
    Eigen::VectorXd nodes_to_driven(const Eigen::VectorXd& nodes) const;
    Eigen::VectorXd solve(LinearSolver& solver, const Eigen::VectorXd& right);

    const RecoveryModel& recovery_;
    const SurfaceObservations& observations_;
    Model free_;  ///< driven nodes free
    Model held_;  ///< driven nodes prescribed, as in `recovery_`
    std::vector<Index> unknown_;
    LinearSolverOptions solver_options_;
    std::unique_ptr<LinearSolver> free_solver_, held_solver_;
    long num_solves_ = 0;
};

}  // namespace palpate

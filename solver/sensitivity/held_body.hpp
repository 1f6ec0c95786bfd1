// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solver/equilibrium/contact_assembly.hpp"
#include "solver/equilibrium/pressure_assembly.hpp"
#include "solver/equilibrium/time_steps.hpp"
#include "solver/equilibrium/viscous_history.hpp"

namespace palpate {

/// A body that goes through given displacements, whether they are its equilibria or not, and
/// remembers what relaxation and friction make of them: for differences of models at held
/// displacements.
class HeldBody {
public:
    /// What pushes back there.
    struct Push {
        Eigen::VectorXd force;  ///< [3 num_nodes] mN, as `InternalForce` with all contacts
        std::vector<Vec3> contact_force;  ///< [contacts] mN, on the body
    };

    /// At rest, before the first time.
    explicit HeldBody(std::shared_ptr<const SolidModel> model);
    HeldBody(const HeldBody&) = delete;
    HeldBody& operator=(const HeldBody&) = delete;

    /// Goes on to the next time. Throws Error(solve_failed) where matter inverts.
    ///   u      [3 num_nodes] mm
    ///   loads  obstacles' motions and pressures then; displacements and forces are not used
    Push advance(double time_s, const Eigen::VectorXd& u, const SolidLoads& loads);

private:
    std::shared_ptr<const SolidModel> model_;
    SolidAssembly solid_;
    ContactAssembly contact_;
    PressureAssembly pressure_;
    ViscousHistory history_;
    ContactStart start_;
    double time_s_ = 0;
};

}  // namespace palpate

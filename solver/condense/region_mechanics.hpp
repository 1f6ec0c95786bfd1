// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>

#include "solver/linear/linear_solver.hpp"
#include "solver/model/solid_model.hpp"
#include "solver/model/stiffness_matrix.hpp"

namespace palpate {

/// What condensation asks of a body, most often one region at unit modulus, whatever mechanics it
/// obeys.
class RegionMechanics {
public:
    virtual ~RegionMechanics() = default;
    /// K without regard to prescribed dofs, mN/mm.
    virtual const StiffnessMatrix& stiffness() const = 0;
    /// As `LinearSolver::solve`.
    virtual LinearSolverSummary solve(const Columns& b, Columns& x) = 0;
    virtual LinearSolverInfo describe() const = 0;
};

/// At rest. `part`: one material of modulus 1.
std::unique_ptr<RegionMechanics> make_region_at_rest(const SolidModel& part,
                                                     const LinearSolverOptions& options);

/// The tangent at the displacement u [3 num_nodes] mm. Throws Error(solve_failed) if it is not
/// positive definite on the free dofs: the state is not stable.
std::unique_ptr<RegionMechanics> make_tangent_mechanics(const SolidModel& body,
                                                        const Eigen::VectorXd& u,
                                                        const LinearSolverOptions& options);

}  // namespace palpate

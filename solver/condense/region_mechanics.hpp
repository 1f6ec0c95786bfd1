// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>

#include "solver/linear/linear_solver.hpp"
#include "solver/model/solid_model.hpp"
#include "solver/model/stiffness_matrix.hpp"

namespace palpate {

/// The nodes and elements of one region as a model of its own: what condensation asks of whatever
/// mechanics the region obeys, all at unit modulus.
class RegionMechanics {
public:
    virtual ~RegionMechanics() = default;
    /// K of the region without regard to prescribed dofs, mN/mm per kPa.
    virtual const StiffnessMatrix& stiffness() const = 0;
    /// As `LinearSolver::solve`.
    virtual LinearSolverSummary solve(const Columns& b, Columns& x) = 0;
    virtual LinearSolverInfo describe() const = 0;
    /// [3 num_nodes] mN per kPa: the internal forces where the stiffness was taken; empty at rest.
    virtual const Eigen::VectorXd& force() const = 0;
};

/// At rest. `part`: one material of modulus 1.
std::unique_ptr<RegionMechanics> make_region_at_rest(const SolidModel& part,
                                                     const LinearSolverOptions& options);

/// The tangent at the displacement u [3 num_nodes] mm. Throws Error(solve_failed) if it is not
/// positive definite on the free dofs: the state is not stable.
std::unique_ptr<RegionMechanics> make_tangent_region(const SolidModel& part,
                                                     const Eigen::VectorXd& u,
                                                     const LinearSolverOptions& options);

/// Its `force` alone.
Eigen::VectorXd force_of_region(const SolidModel& part, const Eigen::VectorXd& u);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "solver/linear/linear_solver.hpp"
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

/// Linear elasticity. `part`: one material of modulus 1.
std::unique_ptr<RegionMechanics> make_linear_region(const Model& part,
                                                    const LinearSolverOptions& options);

/// The tangent of a law of the registry with the parameters `stiffness_kpa` and `poisson_ratio`, at
/// the displacement u [3 num_nodes] mm. Throws Error(solve_failed) if the tangent is not positive
/// definite on the free dofs: the state is not stable.
std::unique_ptr<RegionMechanics> make_tangent_region(const Model& part, const std::string& law,
                                                     const Eigen::VectorXd& u,
                                                     const LinearSolverOptions& options);

/// Its `force` alone.
Eigen::VectorXd force_of_region(const Model& part, const std::string& law,
                                const Eigen::VectorXd& u);

}  // namespace palpate

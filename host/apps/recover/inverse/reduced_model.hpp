// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "solver/condense/condensation.hpp"

namespace palpate {

/// The mechanics that the inverse problem sees: equilibrium of the observed nodes,
///   S_oo(E) u_o + S_od(E) u_d = 0,   S(E) = sum_r E_r S_r.
/// Linear elasticity is exact for every modulus (method.md, 1.3). Matrices in mN/mm, displacements
/// in mm.
class ReducedModel {
public:
    /// `stiffness_kpa` [num regions]: the moduli of regions that are not changed later.
    ReducedModel(std::vector<CondensedRegion> regions, Index num_observed, Index num_driven,
                 std::vector<double> stiffness_kpa);

    Index observed_dofs() const { return 3 * num_observed_; }
    Index driven_dofs() const { return 3 * num_driven_; }
    const std::vector<CondensedRegion>& regions() const { return regions_; }
    /// Moduli of all regions as they were given [num regions].
    const std::vector<double>& stiffness_kpa() const { return stiffness_kpa_; }
    /// Whether a region's modulus has any influence on the observed nodes.
    bool has_region(Index region) const;

    // `kpa`: moduli of all regions [num regions].

    /// S_oo, [observed_dofs, observed_dofs].
    Eigen::MatrixXd stiffness(const std::vector<double>& kpa) const;
    /// S_od x for columns x [driven_dofs, any].
    Eigen::MatrixXd coupling_times(const std::vector<double>& kpa,
                                   const Eigen::MatrixXd& driven) const;
    /// S_od^T x for columns x [observed_dofs, any].
    Eigen::MatrixXd transposed_coupling_times(const std::vector<double>& kpa,
                                              const Eigen::MatrixXd& observed) const;
    /// u_o for given u_d: one dense factorisation of S_oo. Throws Error(solve_failed) if S_oo is
    /// not positive definite.
    Eigen::VectorXd observed_displacement(const std::vector<double>& kpa,
                                          const Eigen::VectorXd& driven) const;

    /// S_r,oo x of one region at unit modulus, for columns x [observed_dofs, any].
    Eigen::MatrixXd unit_stiffness_times(const CondensedRegion& region,
                                         const Eigen::MatrixXd& x) const;
    /// S_r,od x of one region at unit modulus, for columns x [driven_dofs, any].
    Eigen::MatrixXd unit_coupling_times(const CondensedRegion& region,
                                        const Eigen::MatrixXd& driven) const;

private:
    std::vector<CondensedRegion> regions_;
    Index num_observed_;
    Index num_driven_;
    std::vector<double> stiffness_kpa_;
};

/// Cholesky factor of a dense symmetric matrix; Error(solve_failed) naming `what` if it fails.
Eigen::LLT<Eigen::MatrixXd> cholesky(const Eigen::MatrixXd& matrix, const char* what);
/// Throws Error(solve_failed) as `cholesky` does.
[[noreturn]] void throw_indefinite(const char* what, Index rows);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "solver/condense/condensation.hpp"

namespace palpate {

/// The displacement at which mechanics were linearised. Empty: at rest.
struct LinearisationPoint {
    Eigen::VectorXd driven;    ///< u_d* [driven_dofs] mm
    Eigen::VectorXd observed;  ///< u_o* [observed_dofs] mm
    bool is_rest() const { return observed.size() == 0; }
};

/// The mechanics that the inverse problem sees: equilibrium of the observed nodes,
///   S_oo(E) (u_o - u_o*) + S_od(E) (u_d - u_d*) + g(E) = 0,   S(E) = sum_r E_r S_r, g likewise.
/// At rest u* and g are zero, and linear elasticity is exact for every modulus (method.md, 1.3);
/// elsewhere (`condense_at`) it is large deformation to first order (method.md, 10.2). Matrices in
/// mN/mm, displacements in mm.
class ReducedModel {
public:
    /// `stiffness_kpa` [num regions]: the moduli of regions that are not changed later.
    ReducedModel(std::vector<CondensedRegion> regions, Index num_observed, Index num_driven,
                 std::vector<double> stiffness_kpa, LinearisationPoint point = {});

    Index observed_dofs() const { return 3 * num_observed_; }
    Index driven_dofs() const { return 3 * num_driven_; }
    const std::vector<CondensedRegion>& regions() const { return regions_; }
    const LinearisationPoint& point() const { return point_; }
    /// Moduli of all regions as they were given [num regions].
    const std::vector<double>& stiffness_kpa() const { return stiffness_kpa_; }
    /// The same blocks about another point near the old one, with the forces there (`region_forces`
    /// of the same model). Throws Error(invalid_argument) if they are of other regions.
    void move_to(LinearisationPoint point, const std::vector<CondensedRegion>& forces);
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
    /// g, [observed_dofs] mN: what is not balanced where the mechanics were linearised.
    Eigen::VectorXd imbalance(const std::vector<double>& kpa) const;
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
    /// g_r of one region at unit modulus [observed_dofs].
    Eigen::VectorXd unit_force(const CondensedRegion& region) const;

private:
    std::vector<CondensedRegion> regions_;
    Index num_observed_;
    Index num_driven_;
    std::vector<double> stiffness_kpa_;
    LinearisationPoint point_;
};

/// Cholesky factor of a dense symmetric matrix; Error(solve_failed) naming `what` if it fails.
Eigen::LLT<Eigen::MatrixXd> cholesky(const Eigen::MatrixXd& matrix, const char* what);
/// Throws Error(solve_failed) as `cholesky` does.
[[noreturn]] void throw_indefinite(const char* what, Index rows);

}  // namespace palpate

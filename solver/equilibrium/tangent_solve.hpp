// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "solver/equilibrium/contact_assembly.hpp"
#include "solver/equilibrium/pressure_assembly.hpp"
#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/linear/flexible_gmres.hpp"
#include "solver/linear/free_dofs.hpp"
#include "solver/linear/low_rank_update.hpp"
#include "solver/linear/matrix_solver.hpp"

namespace palpate {

/// The tangent K of a SolidAssembly, its contacts and its following pressures, to be solved with on
/// the free dofs at one displacement after the other, by a factor or by conjugate gradients
/// (`MatrixSolver`). These take symmetric matrices: of a load stiffness they get the symmetric
/// half. The other half stands at the nodes of open edges; where these are few a factor takes it as
/// a `LowRankUpdate`, else the half preconditions GMRES with the whole (`flexible_gmres`). So there
/// is no unsymmetric factor.
class TangentSolve {
public:
    /// `solid` must outlive this object.
    TangentSolve(const SolidAssembly& solid, const MatrixSolverOptions& options);

    const FreeDofs& free() const { return free_; }
    ContactAssembly& contact() { return contact_; }
    const ContactAssembly& contact() const { return contact_; }
    PressureAssembly& pressure() { return pressure_; }
    const PressureAssembly& pressure() const { return pressure_; }
    /// At u [3 num_nodes] mm, with `shift` times the mean of K's diagonal added to it. False if
    /// the symmetric half of that is not positive definite. Shifted it is that half alone.
    bool factorise(const Eigen::VectorXd& u, double shift = 0);
    /// Whether there is a factor, of whichever tangent.
    bool is_factorised() const { return is_factorised_; }
    /// x with K_ff^T x_f = r_f, x_p = 0, for the tangent at u to a relative residual of 1e-12, at
    /// worst 1e-9; here the limits of friction follow the pressure, so K is not symmetric, nor is
    /// it where pressures follow a surface with a free edge. The last factor serves if it is near
    /// enough, else a new one is made. False if that fails.
    bool solve_at(const Eigen::VectorXd& u, const Eigen::VectorXd& r, Eigen::VectorXd& x);
    /// The same for many right-hand sides R [3 num_nodes, columns], side by side; `is_transposed`
    /// false: with K instead of K^T.
    ///   tolerance   of the relative residual, where less than 1e-12 will do
    bool solve_columns_at(const Eigen::VectorXd& u, const Eigen::MatrixXd& r, Eigen::MatrixXd& x,
                          bool is_transposed = true, double tolerance = 1e-12);
    /// x with K_ff x_f = R_f - K_fp x_p for many columns, K as in `solve_columns_at` not
    /// transposed: x [3 num_nodes, columns] holds x_p at prescribed dofs on entry. False if that
    /// fails.
    bool solve_changes_at(const Eigen::VectorXd& u, const Eigen::MatrixXd& r, Eigen::MatrixXd& x);
    /// Whether the last factorisation or solve failed because K is not positive definite.
    bool is_indefinite() const { return solver_->is_indefinite(); }
    /// Why the last factorisation or solve failed.
    const std::string& failure() const { return solver_->failure(); }
    /// Who solves, and why so.
    LinearSolverInfo solver() const { return solver_->describe(); }
    /// A norm of forces that says nothing: what rounding of u leaves of K u.
    double force_of_rounding(const Eigen::VectorXd& u) const;
    /// x with K_ff x_f = r_f - K_fp x_p: x [3 num_nodes] holds x_p at prescribed dofs on entry.
    /// False if that shows K not to be positive definite, or is not found.
    bool solve(const Eigen::VectorXd& r, Eigen::VectorXd& x) const;
    /// K x with all rows and columns, [3 num_nodes]; after `solve_at` K^T x.
    Eigen::MatrixXd times(const Eigen::MatrixXd& x) const;

private:
    void fill_matrix(const Eigen::VectorXd& u);
    void keep_free(Eigen::Ref<Eigen::MatrixXd> columns) const;
    void find_update(const Eigen::VectorXd& u);
    bool solve_with_factor(const Eigen::MatrixXd& r, bool is_transposed,
                           Eigen::Ref<Eigen::MatrixXd> x) const;
    bool solve_unsymmetric(const Eigen::VectorXd& r, const GmresOptions& options, double tolerance,
                           Eigen::VectorXd& x) const;
    bool refine(const Eigen::MatrixXd& r, double tolerance, bool is_transposed,
                Eigen::Ref<Eigen::MatrixXd> x) const;
    bool refine_columns(const Eigen::MatrixXd& r, double tolerance, bool is_transposed,
                        Eigen::MatrixXd& x) const;
    /// Calls work() with the tangent at u and the last factor, if that is near enough for it to
    /// return true, else with a new one.
    template <class Work>
    bool with_tangent_at(const Eigen::VectorXd& u, bool is_transposed, const Work& work);

    const SolidAssembly& solid_;
    ContactAssembly contact_;
    PressureAssembly pressure_;
    BlockMatrix matrix_;
    FreeDofs free_;
    std::unique_ptr<MatrixSolver> solver_;
    bool is_factorised_ = false;
    bool is_unsymmetric_ = false;  ///< `matrix_` has what the last `factorise` left out
    bool is_updated_ = false;      ///< `update_` makes the factor that of the whole tangent
    LowRankUpdate update_;
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "solver/linear/linear_solver.hpp"
#include "solver/model/block_matrix.hpp"

namespace palpate {

/// How a tangent is solved with.
struct MatrixSolverOptions {
    /// `automatic`: factorised on the host where that is small, else multigrid on the back end; the
    /// host again where there is no device that can be used, or where conjugate gradients fail.
    LinearMethod method = LinearMethod::direct;
    /// Of a factorisation, see `make_sparse_factor`. Empty: Eigen for small systems, else the
    /// first.
    std::string direct_library = {};
    std::string backend = "opencl";  ///< where conjugate gradients run
    BackendOptions device = {};
    double relative_tolerance = 1e-4;  ///< of conjugate gradients; Newton's method refines
    int max_iterations = 2000;         ///< of conjugate gradients
};

/// The same method, back end and library for tangents; tolerances stay those of Newton's method.
MatrixSolverOptions matrix_solver_options(const LinearSolverOptions& options);

/// Solves with a symmetric matrix of 3x3 blocks on the free dofs of a mesh, again and again with
/// new values: the tangent of Newton's method, which may turn out not to be positive definite.
class MatrixSolver {
public:
    virtual ~MatrixSolver() = default;
    /// From now on solves with `matrix` (without regard to prescribed dofs) plus `shift` times the
    /// mean of its free diagonal. False if that is seen not to be positive definite: conjugate
    /// gradients look for it here only when the matrix before was not, and else while they solve.
    virtual bool set(const BlockMatrix& matrix, double shift) = 0;
    /// x_f = K_ff^-1 right_f; other rows of x stay. False if K is not positive definite or the
    /// iterations do not get there: x then means nothing.
    ///   right, x  [3 num_nodes, columns]
    virtual bool solve(const Eigen::MatrixXd& right, Eigen::Ref<Eigen::MatrixXd> x) = 0;
    /// Whether `solve` errs by no more than rounding does.
    virtual bool is_direct() const = 0;
    /// Whether the last `set` or `solve` found the matrix not to be positive definite: a larger
    /// shift may then help.
    virtual bool is_indefinite() const = 0;
    /// Why the last `set` or `solve` failed.
    virtual const std::string& failure() const = 0;
    /// Who solves at present, and why so.
    virtual LinearSolverInfo describe() const = 0;
};

/// The mesh that the matrices belong to.
struct MatrixSolverMesh {
    std::span<const Vec3> nodes;               ///< [num_nodes] mm
    std::span<const std::uint8_t> prescribed;  ///< [3 num_nodes]
    const Adjacency& graph;                    ///< of the matrices
};

/// Copies what it needs of `mesh`. Throws as `make_sparse_factor` and, if the method is not
/// `automatic`, `make_backend` do.
std::unique_ptr<MatrixSolver> make_matrix_solver(const MatrixSolverMesh& mesh,
                                                 const MatrixSolverOptions& options);

/// Its parts: a factorisation on the host; conjugate gradients on a back end, preconditioned by
/// multigrid or by the diagonal blocks.
std::unique_ptr<MatrixSolver> make_factor_solver(const MatrixSolverMesh& mesh,
                                                 const MatrixSolverOptions& options);
std::unique_ptr<MatrixSolver> make_gradient_solver(const MatrixSolverMesh& mesh,
                                                   const MatrixSolverOptions& options);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "solver/backend/backend.hpp"
#include "solver/base/log.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// Dense columns on the host, [rows, columns], column index fastest like `DeviceVector`.
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// How K x = b is solved.
enum class LinearMethod {
    automatic,  ///< by size, number of columns and device (choose_method.hpp)
    multigrid,  ///< conjugate gradients, preconditioned by multigrid: large models
    jacobi,     ///< conjugate gradients, preconditioned by the 3x3 diagonal blocks: few columns
    direct,     ///< one factorisation per set of moduli, on the host: many columns, small models
};
/// "auto", "multigrid", "jacobi", "direct".
const char* name_of(LinearMethod method);

struct LinearSolverOptions {
    std::string backend = "opencl";  ///< where conjugate gradients run; `direct` needs none
    BackendOptions device;
    LinearMethod method = LinearMethod::automatic;
    Index expected_columns = 1;        ///< right-hand sides to be solved per set of moduli: what
                                       ///< `automatic` weighs the set-up against
    std::string direct_library;        ///< of `sparse_factor_names`; empty: the first of them
    double relative_tolerance = 1e-8;  ///< on |b - K x| / |b|, per column, checked in fp64
    int max_iterations = 20000;        ///< of CG, per refinement step
    int max_refinements = 12;          ///< fp64 refinement steps round the device solve
    Index columns_per_batch = 16;      ///< columns that share one pass over the mesh
};

struct LinearSolverSummary {
    bool converged = false;
    int iterations = 0;            ///< CG iterations, summed over batches and refinements
    int refinements = 0;           ///< largest number any batch needed
    double relative_residual = 0;  ///< largest over the columns, fp64, checked on the host
    double seconds = 0;
    std::string message;
};

/// Who solves, how, and why so: written into every result.
struct LinearSolverInfo {
    BackendInfo device;
    LinearMethod method = LinearMethod::automatic;
    std::string library;  ///< of a direct solver, with its version; else empty
    std::string reason;   ///< one clause: why this method
};

/// A factorisation on the host with `library` (name and version).
LinearSolverInfo host_factor_info(const std::string& library, const std::string& reason);

/// Solves K x = b for the constrained K of one model (identity at prescribed dofs), any number of
/// columns. b holds nodal forces (mN) at free dofs and the prescribed displacement (mm) at
/// prescribed dofs.
class LinearSolver {
public:
    virtual ~LinearSolver() = default;
    /// b, x: [3 num_nodes, columns]. x is an initial guess on entry if `x.rows() > 0`.
    /// Not converging is not an error: see the summary. Throws Error(solve_failed) on NaN.
    virtual LinearSolverSummary solve(const Columns& b, Columns& x,
                                      const ProgressSink& progress = {}) = 0;
    virtual void set_stiffness(std::span<const double> stiffness_kpa) = 0;
    virtual LinearSolverInfo describe() const = 0;
};

}  // namespace palpate

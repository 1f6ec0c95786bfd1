// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "solver/linear/constrained_system.hpp"
#include "solver/linear/free_dofs.hpp"
#include "solver/linear/sparse_factor.hpp"

namespace palpate {

/// Many columns of K x = b by one factorisation of K on its free dofs, in batches shared among the
/// host threads, fp64, refined to `options.relative_tolerance`.
class DirectColumns {
public:
    /// Factorises with `options.direct_library`. `system` must outlive this object. Throws
    /// Error(solve_failed) if K is not positive definite on the free dofs, Error(out_of_memory) if
    /// the factor does not fit, Error(unsupported) for an absent library.
    DirectColumns(const ConstrainedMatrix& system, const LinearSolverOptions& options);

    /// After the values of the matrix have changed.
    void factorise();
    /// As `LinearSolver::solve`.
    LinearSolverSummary solve(const Columns& b, Columns& x, const ProgressSink& progress) const;
    LinearSolverInfo describe(const std::string& reason) const;

private:
    LinearSolverSummary solve_batch(const Columns& b, Columns& x, Index first, Index width) const;
    void add_correction(const Columns& r, Columns& u) const;

    const ConstrainedMatrix& system_;
    LinearSolverOptions options_;
    FreeDofs free_;
    std::unique_ptr<SparseFactor> factor_;
    bool analysed_ = false;
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "solver/linear/linear_solver.hpp"
#include "solver/linear/preconditioner.hpp"

namespace palpate {

/// What conjugate gradients know of their matrix.
enum class Curvature {
    trusted,  ///< it is positive definite
    watched,  ///< it may not be: the host looks at every iteration
};

/// Preconditioned conjugate gradients on the operations of `Backend` (Saad, Iterative Methods for
/// Sparse Linear Systems, 2003, algorithm 9.1) for several independent columns that share each pass
/// over the mesh. Step lengths stay on the device; the host looks at the residuals only when some
/// column should be done, by the rate seen so far. A converged column stands still, and once half
/// of them have converged the others go on in narrower vectors.
class BlockCg {
public:
    /// K is the constrained stiffness of `backend`'s prepared model. Both outlive this object.
    BlockCg(Backend& backend, Preconditioner& preconditioner)
        : BlockCg(backend, backend.stiffness(), preconditioner, Curvature::trusted) {}
    /// K is `matrix`, square, of `backend`, the identity at prescribed dofs.
    BlockCg(Backend& backend, const DeviceOperator& matrix, Preconditioner& preconditioner,
            Curvature curvature);

    /// Solves K dx = r, starting at zero.
    ///   r, dx   [rows, columns], 0 at prescribed dofs
    ///   target  [columns] |r - K dx| to reach; a column whose |r| is below stays at zero
    /// Returns the number of iterations, at most `max_iterations`. A column also stops when p . K p
    /// is not positive (rounding has eaten it); where that is watched, all columns stop then.
    /// Throws Error(solve_failed) on NaN.
    int solve(const Columns& r, std::span<const double> target, int max_iterations, Columns& dx);

    /// Whether the last solve stopped at p . K p <= 0 or r . z <= 0 (only where that is watched):
    /// then K or its preconditioner is not positive definite, and dx means nothing.
    bool met_negative_curvature() const { return met_negative_curvature_; }

private:
    struct Workspace {
        std::unique_ptr<DeviceVector> x, r, z, p, q;
        std::array<std::unique_ptr<DeviceSums>, 2> rz, rr;
        std::unique_ptr<DeviceSums> pq, limit;
    };
    class Run;

    std::unique_ptr<Workspace> make_workspace(Index columns);
    /// The workspace of full width, kept from solve to solve.
    Workspace& full_workspace(Index columns);

    Backend& backend_;
    const DeviceOperator& matrix_;
    Preconditioner& preconditioner_;
    Curvature curvature_;
    bool met_negative_curvature_ = false;
    std::unique_ptr<Workspace> full_;
};

/// Smallest number of columns >= `columns` for which the back ends have wide loads: 1, 4, 8, 16 and
/// multiples of 16.
Index padded_columns(Index columns);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "solver/linear/multigrid/hierarchy.hpp"
#include "solver/linear/preconditioner.hpp"

namespace palpate {

/// One V-cycle of smoothed-aggregation multigrid on a device, from zero, symmetric: Chebyshev
/// polynomials in D^-1 A smooth before and after (Adams, Brezina, Hu, Tuminaro, J. Comput. Phys.
/// 188, 2003), restriction is the transposed prolongation, the coarsest level is solved by its
/// dense inverse.
class Multigrid final : public Preconditioner {
public:
    /// Degree of the polynomials, and the share of the spectrum of D^-1 A that they damp: from
    /// lambda_max / 10 up. Degree 2 gave the least time of 1, 2, 3 and 4 on the pelvis meshes.
    static constexpr int smoothing_degree = 2;
    static constexpr double smoothed_share = 10;

    /// Brings `hierarchy` to the device of `backend`, where `matrix` is its level 0 with its
    /// inverted diagonal blocks and the identity at prescribed dofs. Both outlive this object.
    Multigrid(Backend& backend, const DeviceOperator& matrix, const Hierarchy& hierarchy);
    /// Level 0 is the stiffness of the backend's prepared model.
    Multigrid(Backend& backend, const Hierarchy& hierarchy)
        : Multigrid(backend, backend.stiffness(), hierarchy) {}

    /// New values of the same hierarchy.
    void update(const Hierarchy& hierarchy);

    void apply(const DeviceVector& r, DeviceVector& z, DeviceSums& rz) override;
    void keep_only(Index columns) override;

private:
    /// One step y = alpha x + beta y + weight D^-1 (b - A x) of the polynomial.
    struct Step {
        double alpha, beta, weight;
    };
    struct Level {
        std::unique_ptr<DeviceOperator> matrix;  ///< null on level 0
        std::unique_ptr<DeviceOperator> prolongation, restriction;
        std::vector<Step> steps;
    };
    /// Vectors of one level for one number of columns: the right-hand side and the solution (not on
    /// level 0), and one more.
    struct Vectors {
        std::unique_ptr<DeviceVector> b, x, spare;
    };

    const DeviceOperator& matrix_of(std::size_t level) const {
        return level == 0 ? matrix_ : *levels_[level].matrix;
    }
    static std::vector<Step> smoothing_steps(double largest_eigenvalue);
    std::vector<Vectors>& vectors_for(Index columns);
    void cycle(std::size_t level, const DeviceVector& b, DeviceVector& x,
               std::vector<Vectors>& vectors, DeviceSums* bx);

    Backend& backend_;
    const DeviceOperator& matrix_;
    std::vector<Level> levels_;
    std::unique_ptr<DeviceOperator> coarsest_;
    std::map<Index, std::vector<Vectors>> vectors_;
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solver/backend/device_vector.hpp"
#include "solver/model/block_matrix.hpp"

namespace palpate {

/// What a displacement stores and how it pushes back.
struct SolidForce {
    double energy = 0;          ///< mN mm; infinite if not valid
    std::vector<double> force;  ///< [3 num_nodes] mN, dW/du
    bool is_valid = true;       ///< false where matter is inverted at any point
};

/// The element loops of one SolidModel on a back end (`Backend::make_solid`, which it must not
/// outlive), at its precision: the laws alone, so neither contact nor relaxation, and without
/// regard to prescribed dofs. Displacements u are [3 num_nodes] mm on the host. Sums have a fixed
/// order. Errors as those of `Backend`.
class SolidDevice {
public:
    virtual ~SolidDevice() = default;

    virtual SolidForce internal_force(std::span<const double> u) = 0;
    /// K = dF/du at u, mN/mm, symmetric, into the blocks of `matrix`, whose pattern is `node_graph`
    /// of the mesh. Elements with a point that is not valid add nothing.
    virtual void tangent(std::span<const double> u, BlockMatrix& matrix) = 0;
    /// From now on `apply` multiplies with K at u.
    virtual void linearise(std::span<const double> u) = 0;
    /// y = K x from the elements, without a matrix.
    ///   x, y  [3 num_nodes, columns] mm and mN, vectors of the same back end; may not alias
    virtual void apply(const DeviceVector& x, DeviceVector& y) = 0;
    /// lambda . df/dp at u for every parameter p of every material: [materials][parameters], mN mm
    /// per unit of the parameter. lambda [3 num_nodes] mm.
    virtual std::vector<std::vector<double>> parameter_products(std::span<const double> u,
                                                                std::span<const double> lambda) = 0;
};

}  // namespace palpate

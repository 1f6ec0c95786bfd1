// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "solver/backend/device_vector.hpp"
#include "solver/backend/solid_tables.hpp"
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
/// order. Errors as those of `Backend`, which likewise hands arguments that fit to `do_` functions.
class SolidDevice {
public:
    virtual ~SolidDevice() = default;

    SolidForce internal_force(std::span<const double> u);
    /// K = dF/du at u, mN/mm, symmetric, into the blocks of `matrix`, whose pattern is `node_graph`
    /// of the mesh. Elements with a point that is not valid add nothing.
    void tangent(std::span<const double> u, BlockMatrix& matrix);
    /// From now on `apply` multiplies with K at u.
    void linearise(std::span<const double> u);
    /// y = K x from the elements, without a matrix; wants `linearise` first.
    ///   x, y  [3 num_nodes, columns] mm and mN, vectors of the same back end; may not alias
    void apply(const DeviceVector& x, DeviceVector& y);
    /// lambda . df/dp at u for every parameter p of every material: [materials][parameters], mN mm
    /// per unit of the parameter. lambda [3 num_nodes] mm.
    std::vector<std::vector<double>> parameter_products(std::span<const double> u,
                                                        std::span<const double> lambda);

protected:
    explicit SolidDevice(SolidTables tables) : tables_(std::move(tables)) {}
    const SolidTables& tables() const { return tables_; }

    virtual SolidForce do_internal_force(std::span<const double> u) = 0;
    /// Into blocks [graph.items, 9] of the tables.
    virtual void do_tangent(std::span<const double> u, std::span<double> blocks) = 0;
    virtual void do_linearise(std::span<const double> u) = 0;
    virtual void do_apply(const DeviceVector& x, DeviceVector& y) = 0;
    virtual std::vector<std::vector<double>> do_parameter_products(
        std::span<const double> u, std::span<const double> lambda) = 0;

private:
    void require_displacement(const char* function, std::span<const double> u) const;

    SolidTables tables_;
    bool has_state_ = false;  ///< of `linearise`
};

}  // namespace palpate

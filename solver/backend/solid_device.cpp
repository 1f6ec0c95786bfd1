// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backend/solid_device.hpp"

#include <fmt/format.h>

#include "solver/model/refuse.hpp"

namespace palpate {

void SolidDevice::require_displacement(const char* function, std::span<const double> u) const {
    if (u.size() != static_cast<std::size_t>(tables_.num_dofs()))
        refuse(
            fmt::format("SolidDevice::{}: {} numbers were given where {} are needed, 3 per node.",
                        function, u.size(), tables_.num_dofs()));
}

SolidForce SolidDevice::internal_force(std::span<const double> u) {
    require_displacement("internal_force", u);
    return do_internal_force(u);
}

void SolidDevice::tangent(std::span<const double> u, BlockMatrix& matrix) {
    require_displacement("tangent", u);
    if (matrix.block_rows != 3 || matrix.block_columns != 3 ||
        matrix.graph.offsets != tables_.graph.offsets ||
        matrix.graph.items != tables_.graph.items ||
        matrix.blocks.size() != 9 * tables_.graph.items.size())
        refuse(
            "SolidDevice::tangent: the matrix needs 3x3 blocks in the pattern of the mesh's "
            "node_graph.");
    do_tangent(u, matrix.blocks);
}

void SolidDevice::linearise(std::span<const double> u) {
    require_displacement("linearise", u);
    do_linearise(u);
    has_state_ = true;
}

void SolidDevice::apply(const DeviceVector& x, DeviceVector& y) {
    if (!has_state_) refuse("SolidDevice::apply: call linearise(u) first.");
    if (x.rows() != tables_.num_dofs() || y.rows() != x.rows() || y.columns() != x.columns())
        refuse(
            fmt::format("SolidDevice::apply: vectors of {}x{} and {}x{} do not fit: both need {} "
                        "rows, 3 per node, and as many columns.",
                        x.rows(), x.columns(), y.rows(), y.columns(), tables_.num_dofs()));
    if (&x == &y) refuse("SolidDevice::apply: K x cannot overwrite x: give two vectors.");
    do_apply(x, y);
}

std::vector<std::vector<double>> SolidDevice::parameter_products(std::span<const double> u,
                                                                 std::span<const double> lambda) {
    require_displacement("parameter_products", u);
    require_displacement("parameter_products", lambda);
    return do_parameter_products(u, lambda);
}

}  // namespace palpate

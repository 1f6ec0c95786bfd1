// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/equilibrium/solid_assembly.hpp"

namespace palpate {

/// Means over the points of each element, by undeformed volume. [num_elements]
struct CellFields {
    /// Cauchy stress xx, yy, zz, xy, yz, xz, kPa; about an axis zz runs round it.
    std::vector<std::array<double, 6>> stress_kpa;
    std::vector<double> von_mises_kpa;       ///< of that mean stress
    std::vector<double> volume_ratio;        ///< J; for the law "linear" 1 + tr(strain)
    std::vector<double> energy_density_kpa;  ///< that the law alone stores, per undeformed volume
};

/// The fields at the displacement u [3 num_nodes] of the assembly (its viscous step included).
CellFields cell_fields(const SolidAssembly& solid, const Eigen::VectorXd& u);

}  // namespace palpate

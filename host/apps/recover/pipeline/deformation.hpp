// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "host/apps/recover/modelling/tissue_law.hpp"

namespace palpate {

/// What a displacement does to one region.
struct RegionDeformation {
    /// Smallest and largest volume after over before, at the elements' points; 1, 1 without any.
    std::array<double, 2> jacobian_range{1, 1};
    double strain_energy_mj = 0;  ///< N mm; infinite if matter is inverted at large deformation
};

/// By region of `model`, whose materials give moduli and ratios and `law` the law. `displacement`:
/// [3 num_nodes] mm. At small strains the energy is that of the linear strain, half the work of the
/// forces on the body.
std::vector<RegionDeformation> region_deformations(const SolidModel& model, const TissueLaw& law,
                                                   const Eigen::VectorXd& displacement);

}  // namespace palpate

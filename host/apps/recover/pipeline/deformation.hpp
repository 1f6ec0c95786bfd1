// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "host/apps/recover/modelling/tissue_law.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// What a displacement does to one region.
struct RegionDeformation {
    /// Smallest and largest of the elements' volumes after over before; 1, 1 without elements.
    std::array<double, 2> jacobian_range{1, 1};
    double strain_energy_mj = 0;  ///< N mm; infinite if an element is inverted at large deformation
};

/// By region of `model`. `displacement`: [3 num_nodes] mm. At small strains the energy is that of
/// the linear strain, half the work of the forces on the body.
std::vector<RegionDeformation> region_deformations(const Model& model, TissueLaw law,
                                                   const Eigen::VectorXd& displacement);

}  // namespace palpate

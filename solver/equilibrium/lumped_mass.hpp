// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// The mass of every node, kg [num_nodes]: each element's mass in proportion to the integrals of
/// the squared shape functions, which is positive for quadratic elements too (Hinton, Rock and
/// Zienkiewicz 1976).
Eigen::VectorXd lumped_mass(const SolidMesh& mesh, double density_kg_per_m3);

}  // namespace palpate

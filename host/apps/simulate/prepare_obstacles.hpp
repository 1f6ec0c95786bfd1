// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/simulate/selection.hpp"

namespace palpate {

/// The contact that an [[obstacle]] asks for. Without a stiffness it is a hundred times the largest
/// Young's modulus at small strains (relaxation terms at their full height) of the elements at its
/// faces over the mean length of these faces' edges; slip is as stiff. Throws
/// Error(invalid_argument) with the line of the obstacle.
Contact contact_of(const ObstacleSettings& settings, const SelectableMesh& in,
                   const std::vector<SolidMaterial>& materials);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/mesh/mesh.hpp"

namespace palpate {

/// Numbers of points along a Morton curve (G. M. Morton, IBM Ltd., 1966) through their bounding
/// cube, 1,024 cells wide: neighbours in space are near in the list, so that products find their
/// operands in the cache. order[k] is the point that comes k-th.
std::vector<Index> spatial_order(const std::vector<Vec3>& points);

/// The mesh with node order[k] as its k-th, and its tets along the same curve.
Mesh renumbered(const Mesh& mesh, const std::vector<Index>& order);

}  // namespace palpate

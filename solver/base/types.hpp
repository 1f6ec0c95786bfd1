// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index = std::int32_t;  ///< node, element and region numbers

using Triangle = std::array<Index, 3>;
using Tet = std::array<Index, 4>;

}  // namespace palpate

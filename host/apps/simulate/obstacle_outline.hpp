// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/model/contact.hpp"

namespace palpate {

/// The half of a tube's or punch's outline on one side of its axis, in its own plane: (distance
/// from the axis, height over the end), from far back to far back, of a punch from its centre.
std::vector<Eigen::Vector2d> outline_of(const Obstacle& obstacle, double far_mm);

}  // namespace palpate

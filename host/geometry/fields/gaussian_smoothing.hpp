// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Convolves a volume [size[0] * size[1] * size[2]], index 0 fastest, with a Gaussian of standard
/// deviation `sd` samples along every axis, cut off at three of them; ends continue as they are.
void smooth_gaussian(const std::array<Index, 3>& size, double sd, std::vector<float>& volume);

}  // namespace palpate

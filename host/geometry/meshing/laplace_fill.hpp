// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "host/io/image.hpp"

namespace palpate {

/// Replaces the voxels of `image` where `unknown` is 1 by the solution of Laplace's equation with
/// all other voxels as boundary values and zero normal derivative at the image border.
///   image    [num_voxels], any vectors; content at unknown voxels is ignored
///   unknown  [num_voxels], 0 or 1; if all are 1 the image becomes zero
///   tolerance  cycles stop when their last pass changes no component by more (units of the image);
///              the error left is some fifteen times as large
/// Full multigrid with red-black Gauss-Seidel in single precision; seven-point stencil weighted by
/// the spacing, coarsened first along the finer axes. Cost: about
/// 1.2 s for 200^3 voxels with a tenth unknown, 3 s with nearly all unknown (two cores).
void laplace_fill(Image<Vec3>& image, const std::vector<std::uint8_t>& unknown,
                  double tolerance = 5e-4);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "solver/base/types.hpp"

namespace palpate {

/// Where to look for a blurred edge.
struct EdgePlace {
    const float* column = nullptr;  ///< [rows] what its pixels show beyond a dark background
    Index row = 0;                  ///< the edge is near the upper end of this pixel
    float width = 1;                ///< standard deviation of the blur, pixels
};

/// A blurred edge in a column of pixels.
struct FittedEdge {
    float row = 0, sd = 0;      ///< of the edge, pixels
    float step = 0;             ///< grey values from the dark to the bright side
    float variance = 0;         ///< of the residuals, grey values squared
    float slope_of_width = 0;   ///< sums over pixels of residual times d grey / d ln width and
    float weight_of_width = 0;  ///< of its square: their quotient is what ln width lacks
};

/// Fits I(y) = a + step Phi((y - row) / width) + d max(y - row, 0) to 4 rows before and behind each
/// place by Gauss-Newton, Phi the normal distribution function (an edge under a Gaussian blur). d,
/// the tissue's own slope of light, is held near 0 by a prior of 3 % of the step per pixel, a near
/// 0 by one of 4 grey values. The sd is of the noise given (grey values), or of the residuals if
/// they are larger. `edges` has as many as `places`.
void fit_edges(std::span<const EdgePlace> places, Index rows, float noise,
               std::span<FittedEdge> edges);

}  // namespace palpate

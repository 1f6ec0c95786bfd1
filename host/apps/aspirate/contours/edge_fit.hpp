// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/types.hpp"

namespace palpate {

/// A blurred edge in a column of pixels.
struct FittedEdge {
    double row = 0, sd = 0;      ///< of the edge, pixels
    double step = 0;             ///< grey values from the dark to the bright side
    double variance = 0;         ///< of the residuals, grey values squared
    double slope_of_width = 0;   ///< sums over pixels of residual times d grey / d ln width and
    double weight_of_width = 0;  ///< of its square: their quotient is what ln width lacks
};

/// Fits I(y) = a + step Phi((y - row) / width) + d max(y - row, 0) to 4 rows before and behind by
/// Gauss-Newton, Phi the normal distribution function (an edge under a Gaussian blur). d, the
/// tissue's own slope of light, is held near 0 by a prior of 3 % of the step per pixel, a near
/// `dark`. The sd is of the noise given, or of the residuals if they are larger.
///   column       [rows] grey values
///   first        the row to begin with
FittedEdge fit_edge(const float* column, Index rows, double first, double width, double dark,
                    double noise);

}  // namespace palpate

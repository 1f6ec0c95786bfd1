// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace palpate {

/// A smooth curve y(x) through points with ascending x: cubic Hermite pieces whose slope at a point
/// is that of the parabola through it and its neighbours (Bessel). Straight facets between nodes
/// sag, and kink as nodes slide past the places where they are read.
class SmoothCurve {
public:
    /// At least three points.
    SmoothCurve(std::vector<double> x, std::vector<double> y);
    /// Goes on straight beyond the ends.
    double at(double x) const;

private:
    std::vector<double> x_, y_, slope_;
};

}  // namespace palpate

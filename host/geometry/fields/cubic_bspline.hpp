// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Replaces samples by the coefficients of the cubic B-spline through them (Unser, IEEE Signal
/// Processing Magazine 16(6), 1999; ends mirrored).
///   volume  [size[0] * size[1] * size[2]], index 0 fastest; at least 4 samples per axis
void to_bspline_coefficients(const std::array<Index, 3>& size, std::vector<float>& volume);

/// Value of the spline at a continuous index; `gradient`, if given, receives its derivative by the
/// index (per sample, not per mm). Every entry of `index` must lie in 1 .. size - 2, where no
/// support is missing: `clamped_to_support` does that.
double bspline_value(const std::array<Index, 3>& size, const float* coefficients, const Vec3& index,
                     Vec3* gradient = nullptr);

/// A mixed derivative by the index, `orders` 0..2 per axis; slower than the above.
double bspline_derivative(const std::array<Index, 3>& size, const float* coefficients,
                          const Vec3& index, const std::array<int, 3>& orders);

inline Vec3 clamped_to_support(const std::array<Index, 3>& size, const Vec3& index) {
    return index.cwiseMax(Vec3::Ones()).cwiseMin(Vec3(size[0] - 2.0, size[1] - 2.0, size[2] - 2.0));
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include "host/io/image.hpp"

namespace palpate {

/// Trilinear between voxel centres, the border's value beyond them. `Sum`: what values are added
/// up in.
template <typename Sum, typename Value>
Sum linear_value(const Image<Value>& image, const Vec3& point) {
    const Vec3 index = image.grid.to_index(point);
    std::array<Index, 3> low{}, high{};
    Vec3 t;
    for (int axis = 0; axis < 3; ++axis) {
        const double x = std::clamp(index[axis], 0.0, image.grid.size[axis] - 1.0);
        low[axis] = static_cast<Index>(x);
        high[axis] = std::min<Index>(low[axis] + 1, image.grid.size[axis] - 1);
        t[axis] = x - low[axis];
    }
    const auto along_i = [&](Index j, Index k) -> Sum {
        return (1 - t[0]) * image.at(low[0], j, k) + t[0] * image.at(high[0], j, k);
    };
    const auto along_j = [&](Index k) -> Sum {
        return (1 - t[1]) * along_i(low[1], k) + t[1] * along_i(high[1], k);
    };
    return (1 - t[2]) * along_j(low[2]) + t[2] * along_j(high[2]);
}

}  // namespace palpate

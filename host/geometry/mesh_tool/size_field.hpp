// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate::mesh_tool {

/// Wanted edge length (mm) in space: as given at some points, growing by `growth` mm per mm away
/// from them up to `largest`. Held on a coarse grid, interpolated linearly.
class SizeField {
public:
    SizeField(const std::vector<Vec3>& points, const std::vector<double>& sizes, double growth,
              double largest);
    double at(const Vec3& point) const;

private:
    std::size_t offset(const std::array<Index, 3>& i) const {
        return i[0] + std::size_t(size_[0]) * (i[1] + std::size_t(size_[1]) * i[2]);
    }
    void start_from(const Vec3& point, double size, double growth);
    void sweep(double growth, int step);

    std::array<Index, 3> size_{};
    Vec3 origin_ = Vec3::Zero();
    double spacing_ = 1;
    std::vector<double> values_;
};

/// The mean length of the edges at each vertex (0 for unused ones).
std::vector<double> mean_edge_lengths(const std::vector<Vec3>& vertices,
                                      const std::vector<Triangle>& triangles);

}  // namespace palpate::mesh_tool

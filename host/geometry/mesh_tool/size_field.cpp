// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/size_field.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::mesh_tool {

namespace {
constexpr double cells_along_longest_side = 64;
}

SizeField::SizeField(const std::vector<Vec3>& points, const std::vector<double>& sizes,
                     double growth, double largest) {
    Vec3 low = points.front(), high = points.front();
    for (const Vec3& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    spacing_ = std::max((high - low).maxCoeff() / cells_along_longest_side, 1e-9);
    origin_ = low - Vec3::Constant(spacing_);
    for (int axis = 0; axis < 3; ++axis)
        size_[axis] = static_cast<Index>(std::ceil((high - low)[axis] / spacing_)) + 3;
    values_.assign(std::size_t(size_[0]) * size_[1] * size_[2], largest);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (sizes[i] > 0) start_from(points[i], sizes[i], growth);
    for (int repeat = 0; repeat < 2; ++repeat) {
        sweep(growth, 1);
        sweep(growth, -1);
    }
}

void SizeField::start_from(const Vec3& point, double size, double growth) {
    const Vec3 index = (point - origin_) / spacing_;
    for (int corner = 0; corner < 8; ++corner) {
        const std::array<Index, 3> i{static_cast<Index>(index.x()) + (corner & 1),
                                     static_cast<Index>(index.y()) + ((corner >> 1) & 1),
                                     static_cast<Index>(index.z()) + (corner >> 2)};
        const double distance = spacing_ * (Vec3(i[0], i[1], i[2]) - index).norm();
        double& value = values_[offset(i)];
        value = std::min(value, size + growth * distance);
    }
}

/// One pass of the chamfer distance: each grid point learns from the half of its 26 neighbours that
/// were visited before it.
void SizeField::sweep(double growth, int step) {
    const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(values_.size());
    for (std::ptrdiff_t n = step > 0 ? 0 : count - 1; n >= 0 && n < count; n += step) {
        const std::array<Index, 3> i{static_cast<Index>(n % size_[0]),
                                     static_cast<Index>(n / size_[0] % size_[1]),
                                     static_cast<Index>(n / size_[0] / size_[1])};
        for (int k = 0; k < 13; ++k) {  // offsets (-1,-1,-1) .. (-1,0,0): those before the centre
            const std::array<Index, 3> j{i[0] + step * (k % 3 - 1), i[1] + step * (k / 3 % 3 - 1),
                                         i[2] + step * (k / 9 - 1)};
            bool inside = true;
            for (int axis = 0; axis < 3; ++axis) inside &= j[axis] >= 0 && j[axis] < size_[axis];
            if (!inside) continue;
            const double distance = spacing_ * Vec3(j[0] - i[0], j[1] - i[1], j[2] - i[2]).norm();
            values_[n] = std::min(values_[n], values_[offset(j)] + growth * distance);
        }
    }
}

double SizeField::at(const Vec3& point) const {
    const Vec3 index = (point - origin_) / spacing_;
    std::array<Index, 3> i{};
    Vec3 t;
    for (int axis = 0; axis < 3; ++axis) {
        const double clamped = std::clamp(index[axis], 0.0, size_[axis] - 1.0);
        i[axis] = std::min(static_cast<Index>(clamped), size_[axis] - 2);
        t[axis] = clamped - i[axis];
    }
    double value = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = (corner >> 1) & 1, dz = corner >> 2;
        value += (dx ? t[0] : 1 - t[0]) * (dy ? t[1] : 1 - t[1]) * (dz ? t[2] : 1 - t[2]) *
                 values_[offset({i[0] + dx, i[1] + dy, i[2] + dz})];
    }
    return value;
}

std::vector<double> mean_edge_lengths(const std::vector<Vec3>& vertices,
                                      const std::vector<Triangle>& triangles) {
    std::vector<double> sum(vertices.size(), 0.0);
    std::vector<int> count(vertices.size(), 0);
    for (const Triangle& t : triangles) {
        for (int k = 0; k < 3; ++k) {
            const Index a = t[k], b = t[(k + 1) % 3];
            const double length = (vertices[a] - vertices[b]).norm();
            sum[a] += length;
            sum[b] += length;
            ++count[a];
            ++count[b];
        }
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        if (count[i]) sum[i] /= count[i];
    return sum;
}

}  // namespace palpate::mesh_tool

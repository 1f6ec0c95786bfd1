// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/picture_surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/geometry/surfaces/zero_level.hpp"

namespace palpate {
namespace {

constexpr double margin_mm = 10.0;

ImageGrid grid_round(const std::vector<Vec3>& points, double spacing_mm) {
    Vec3 low = points.front(), high = points.front();
    for (const Vec3& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    ImageGrid grid;
    grid.origin = low - Vec3::Constant(margin_mm);
    grid.spacing = Vec3::Constant(spacing_mm);
    for (int a = 0; a < 3; ++a) {
        grid.size[a] =
            2 + static_cast<Index>(std::ceil((high[a] - low[a] + 2 * margin_mm) / spacing_mm));
    }
    return grid;
}

}  // namespace

Surface picture_surface(const TargetShape& shape, const std::vector<Vec3>& near,
                        double edge_length_mm, const std::function<bool(const Vec3&)>& keep) {
    if (near.empty()) return {};
    const auto distance = [&shape](const Vec3& point) {
        return shape.measure(point, Vec3::Zero()).mm;
    };
    const ImageGrid grid = grid_round(near, edge_length_mm);
    std::vector<float> samples;
    samples.reserve(grid.num_voxels());
    for (Index k = 0; k < grid.size[2]; ++k) {
        for (Index j = 0; j < grid.size[1]; ++j) {
            for (Index i = 0; i < grid.size[0]; ++i) {
                samples.push_back(static_cast<float>(distance(grid.to_point(Vec3(i, j, k)))));
            }
        }
    }
    Surface surface = zero_level(grid, samples, distance);
    std::erase_if(surface.triangles, [&](const Triangle& t) {
        return !keep((surface.vertices[t[0]] + surface.vertices[t[1]] + surface.vertices[t[2]]) /
                     3.0);
    });
    return surface;
}

Surface picture_of_points(const std::vector<Vec3>& points, double spacing_mm) {
    constexpr std::size_t most_points = 4000;
    const std::size_t step = 1 + points.size() / most_points;
    const double radius = std::clamp(0.4 * spacing_mm, 0.2, 1.0);
    Surface surface;
    for (std::size_t k = 0; k < points.size(); k += step) {
        const Index first = static_cast<Index>(surface.vertices.size());
        for (int a = 0; a < 3; ++a) {
            for (const double side : {-radius, radius}) {
                surface.vertices.push_back(points[k] + side * Vec3::Unit(a));
            }
        }
        for (int face = 0; face < 8; ++face) {
            // One end of each axis; an odd number of low ends turns the triangle round.
            const Index x = face & 1, y = face >> 1 & 1, z = face >> 2 & 1;
            Triangle corners{first + x, first + 2 + y, first + 4 + z};
            if ((x + y + z) % 2 == 0) std::swap(corners[1], corners[2]);
            surface.triangles.push_back(corners);
        }
    }
    return surface;
}

}  // namespace palpate

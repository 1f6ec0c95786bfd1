// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/nearest_triangles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/geometry/surfaces/closest_point.hpp"

namespace palpate {
namespace {

class Propagation {
public:
    Propagation(const Surface& surface, const ImageGrid& grid, double reach_mm)
        : grid_(grid), reach_(static_cast<float>(reach_mm)) {
        nearest.distance.assign(grid.num_voxels(), std::numeric_limits<float>::infinity());
        nearest.triangle.assign(grid.num_voxels(), -1);
        closest_.resize(grid.num_voxels());
        // Corners in the frame of the grid, mm: points are then multiples of the spacing.
        corners_.reserve(surface.triangles.size());
        balls_.reserve(surface.triangles.size());
        for (const Triangle& t : surface.triangles) {
            std::array<Vec3, 3> corners;
            for (int v = 0; v < 3; ++v) {
                corners[v] = grid.to_index(surface.vertices[t[v]]).cwiseProduct(grid.spacing);
            }
            corners_.push_back(corners);
            const Vec3 centre = (corners[0] + corners[1] + corners[2]) / 3;
            double radius = 0;
            for (const Vec3& corner : corners) radius = std::max(radius, (corner - centre).norm());
            balls_.push_back({centre.cast<float>(), static_cast<float>(1.0001 * radius)});
        }
    }

    /// Tries each triangle at the points within two samples of its box.
    void start() {
        for (Index t = 0; t < Index(corners_.size()); ++t) {
            const auto& [a, b, c] = corners_[t];
            const Vec3 low = a.cwiseMin(b).cwiseMin(c).cwiseQuotient(grid_.spacing);
            const Vec3 high = a.cwiseMax(b).cwiseMax(c).cwiseQuotient(grid_.spacing);
            std::array<Index, 3> first, last;
            for (int axis = 0; axis < 3; ++axis) {
                first[axis] = std::max(0, static_cast<Index>(std::ceil(low[axis] - 2)));
                last[axis] =
                    std::min(grid_.size[axis] - 1, static_cast<Index>(std::floor(high[axis] + 2)));
            }
            for (Index k = first[2]; k <= last[2]; ++k)
                for (Index j = first[1]; j <= last[1]; ++j)
                    for (Index i = first[0]; i <= last[0]; ++i)
                        try_triangle(t, grid_.offset(i, j, k), {i, j, k});
        }
    }

    /// One sweep; bit a of `direction` set: axis a runs downward.
    void sweep(int direction) {
        const std::array<std::ptrdiff_t, 3> stride{1, grid_.size[0],
                                                   std::ptrdiff_t(grid_.size[0]) * grid_.size[1]};
        std::array<Index, 3> first, step;
        std::array<std::ptrdiff_t, 3> to_previous;
        for (int a = 0; a < 3; ++a) {
            const bool down = direction >> a & 1;
            first[a] = down ? grid_.size[a] - 1 : 0;
            step[a] = down ? -1 : 1;
            to_previous[a] = -step[a] * stride[a];
        }
        std::array<Index, 3> p = first;
        for (Index k = 0; k < grid_.size[2]; ++k, p[2] += step[2]) {
            p[1] = first[1];
            for (Index j = 0; j < grid_.size[1]; ++j, p[1] += step[1]) {
                p[0] = first[0];
                for (Index i = 0; i < grid_.size[0]; ++i, p[0] += step[0]) {
                    const std::size_t n = grid_.offset(p[0], p[1], p[2]);
                    if (i > 0) take_from(n + to_previous[0], n, p, 0);
                    if (j > 0) take_from(n + to_previous[1], n, p, 1);
                    if (k > 0) take_from(n + to_previous[2], n, p, 2);
                }
            }
        }
    }

    NearestTriangles nearest;

private:
    using Point = Eigen::Vector3f;  // in the frame of the grid, mm
    struct Ball {                   // that holds a triangle
        Point centre;
        float radius;
    };

    void take_from(std::size_t neighbour, std::size_t n, const std::array<Index, 3>& p, int axis) {
        const Index t = nearest.triangle[neighbour];
        if (t < 0 || t == nearest.triangle[n]) return;
        const float there = nearest.distance[neighbour];
        if (there - static_cast<float>(grid_.spacing[axis]) >= nearest.distance[n]) return;
        if (there > reach_) {
            const Point point = at(p).cast<float>();
            offer(t, n, closest_[neighbour], (closest_[neighbour] - point).norm());
        } else {
            try_triangle(t, n, p);
        }
    }

    void try_triangle(Index t, std::size_t n, const std::array<Index, 3>& p) {
        const Vec3 point = at(p);
        const float limit = nearest.distance[n] + balls_[t].radius;
        if ((point.cast<float>() - balls_[t].centre).squaredNorm() > limit * limit) return;
        const auto& [a, b, c] = corners_[t];
        const Vec3 closest = closest_point_of_triangle(point, a, b, c);
        offer(t, n, closest.cast<float>(), static_cast<float>((closest - point).norm()));
    }

    void offer(Index t, std::size_t n, const Point& closest, float distance) {
        if (distance >= nearest.distance[n]) return;
        nearest.distance[n] = distance;
        nearest.triangle[n] = t;
        closest_[n] = closest;
    }

    Vec3 at(const std::array<Index, 3>& p) const {
        return Vec3(p[0], p[1], p[2]).cwiseProduct(grid_.spacing);
    }

    const ImageGrid& grid_;
    float reach_;
    std::vector<Ball> balls_;
    std::vector<Point> closest_;
    std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace

NearestTriangles nearest_triangles(const Surface& surface, const ImageGrid& grid, double reach_mm) {
    Propagation propagation(surface, grid, reach_mm);
    propagation.start();
    for (int direction = 0; direction < 8; ++direction) propagation.sweep(direction);
    return std::move(propagation.nearest);
}

}  // namespace palpate

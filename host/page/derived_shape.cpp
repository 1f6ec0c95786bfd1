// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/derived_shape.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace palpate {
namespace {

/// Cube that each vertex of a triangle lies in, by number; -1 for the others.
std::vector<Index> cubes_of(const std::vector<Vec3>& vertices,
                            const std::vector<Triangle>& triangles, double edge_mm) {
    std::map<std::array<std::int64_t, 3>, Index> number;
    std::vector<Index> cube(vertices.size(), -1);
    Vec3 low = Vec3::Constant(INFINITY);
    for (const Vec3& x : vertices) low = low.cwiseMin(x);
    for (const Triangle& t : triangles)
        for (const Index v : t) {
            if (cube[v] >= 0) continue;
            std::array<std::int64_t, 3> place{};
            for (int k = 0; k < 3; ++k)
                place[k] =
                    static_cast<std::int64_t>(std::floor((vertices[v][k] - low[k]) / edge_mm));
            cube[v] = number.try_emplace(place, static_cast<Index>(number.size())).first->second;
        }
    return cube;
}

/// The vertex of each cube that is nearest to the mean of the cube's.
std::vector<Index> middles(const std::vector<Vec3>& vertices, const std::vector<Index>& cube,
                           std::size_t num_cubes) {
    std::vector<Vec3> sum(num_cubes, Vec3::Zero());
    std::vector<double> count(num_cubes, 0.0), nearest(num_cubes, INFINITY);
    for (std::size_t v = 0; v < cube.size(); ++v) {
        if (cube[v] < 0) continue;
        sum[cube[v]] += vertices[v];
        count[cube[v]] += 1;
    }
    std::vector<Index> middle(num_cubes, 0);
    for (std::size_t v = 0; v < cube.size(); ++v) {
        if (cube[v] < 0) continue;
        const double off = (vertices[v] - sum[cube[v]] / count[cube[v]]).norm();
        if (off >= nearest[cube[v]]) continue;
        nearest[cube[v]] = off;
        middle[cube[v]] = static_cast<Index>(v);
    }
    return middle;
}

/// Sets that are joined until they are the same; the smallest member stands for each.
class Sets {
public:
    explicit Sets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    std::size_t find(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t i, std::size_t k) {
        i = find(i);
        k = find(k);
        parent_[std::max(i, k)] = std::min(i, k);
    }

private:
    std::vector<std::size_t> parent_;
};

}  // namespace

DerivedShape thinned(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                     double edge_mm) {
    const std::vector<Index> cube = cubes_of(vertices, triangles, edge_mm);
    Index last = -1;
    for (const Index c : cube) last = std::max(last, c);
    DerivedShape shape{middles(vertices, cube, static_cast<std::size_t>(last + 1)), {}};
    for (const Triangle& t : triangles) {
        const Triangle kept{cube[t[0]], cube[t[1]], cube[t[2]]};
        if (kept[0] != kept[1] && kept[1] != kept[2] && kept[2] != kept[0])
            shape.triangles.push_back(kept);
    }
    return shape;
}

DerivedShape thinned_to(std::size_t most, const std::vector<Vec3>& vertices,
                        const std::vector<Triangle>& triangles) {
    constexpr double growth = 1.2;
    double area = 0;
    for (const auto& [a, b, c] : triangles) {
        const Vec3 ab = vertices[b] - vertices[a], ac = vertices[c] - vertices[a];
        area += ab.cross(ac).norm() / 2;
    }
    // A surface leaves about two triangles for each h^2 of its area, h the edge of the cubes.
    constexpr double smallest_mm = 1e-9;
    double edge_mm = smallest_mm + std::sqrt(2 * area / double(std::max<std::size_t>(most, 1)));
    for (;; edge_mm *= growth) {
        DerivedShape shape = thinned(vertices, triangles, edge_mm);
        if (shape.triangles.size() <= most) return shape;
    }
}

DerivedShape split_at_creases(const std::vector<Vec3>& vertices,
                              const std::vector<Triangle>& triangles) {
    constexpr double crease_cosine = 0.766;                             // of 40 degrees
    std::map<std::pair<Index, Index>, std::vector<std::size_t>> sides;  // corner where each begins
    std::vector<Vec3> normal;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        const Vec3 ab = vertices[b] - vertices[a], ac = vertices[c] - vertices[a];
        normal.push_back(ab.cross(ac).normalized());
        for (std::size_t k = 0; k < 3; ++k)
            sides[std::minmax(triangles[t][k], triangles[t][(k + 1) % 3])].push_back(3 * t + k);
    }
    const auto next = [](std::size_t corner) { return corner - corner % 3 + (corner + 1) % 3; };
    const auto vertex = [&](std::size_t corner) { return triangles[corner / 3][corner % 3]; };
    Sets corners(3 * triangles.size());
    for (const auto& [edge, begins] : sides) {
        if (begins.size() != 2) continue;
        const auto [i, k] = std::pair(begins[0], begins[1]);
        if (normal[i / 3].dot(normal[k / 3]) < crease_cosine) continue;
        const bool is_along = vertex(i) == vertex(k);  // else the other way, as neighbours should
        corners.join(i, is_along ? k : next(k));
        corners.join(next(i), is_along ? next(k) : k);
    }
    DerivedShape shape{{}, triangles};
    std::vector<Index> number(3 * triangles.size(), -1);
    for (std::size_t corner = 0; corner < number.size(); ++corner) {
        Index& of_set = number[corners.find(corner)];
        if (of_set < 0) {
            of_set = static_cast<Index>(shape.source.size());
            shape.source.push_back(vertex(corner));
        }
        shape.triangles[corner / 3][corner % 3] = of_set;
    }
    return shape;
}

}  // namespace palpate

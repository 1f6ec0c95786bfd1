// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/zero_level.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

/// The six tetrahedra of a cube, corners as bit masks (bit a: one step along axis a). Every edge
/// runs from a corner to one that holds all its bits, so neighbouring cubes agree on their faces.
constexpr int tets[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                            {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

class MarchingTets {
public:
    MarchingTets(const ImageGrid& grid, const std::vector<float>& samples)
        : grid_(grid), samples_(samples) {}

    void march() {
        for (Index k = 0; k + 1 < grid_.size[2]; ++k)
            for (Index j = 0; j + 1 < grid_.size[1]; ++j)
                for (Index i = 0; i + 1 < grid_.size[0]; ++i) march_cell({i, j, k});
    }

    /// Moves every vertex along its edge onto the zero of the function.
    void refine(const std::function<double(const Vec3&)>& function) {
        parallel_ranges(edges_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                surface.vertices[v] = zero_on_edge(edges_[v], function);
            }
        });
    }

    Surface surface;

private:
    using Node = std::array<Index, 3>;
    struct Edge {
        Vec3 inside, outside;
        double value_inside, value_outside;
    };

    void march_cell(const Node& node) {
        std::array<float, 8> values;
        int num_inside = 0;
        for (int corner = 0; corner < 8; ++corner) {
            values[corner] = samples_[offset(node, corner)];
            num_inside += values[corner] < 0;
        }
        if (num_inside == 0 || num_inside == 8) return;
        for (const auto& tet : tets) march_tet(node, tet, values);
    }

    void march_tet(const Node& node, const int (&tet)[4], const std::array<float, 8>& values) {
        std::array<int, 4> inside, outside;
        int num_inside = 0, num_outside = 0;
        for (int corner : tet) {
            if (values[corner] < 0)
                inside[num_inside++] = corner;
            else
                outside[num_outside++] = corner;
        }
        if (num_inside == 0 || num_outside == 0) return;
        const Vec3 outward = point(node, outside[0]) - point(node, inside[0]);
        auto vertex = [&](int a, int b) { return vertex_on(node, a, b); };
        if (num_inside == 1) {
            add({vertex(inside[0], outside[0]), vertex(inside[0], outside[1]),
                 vertex(inside[0], outside[2])},
                outward);
        } else if (num_inside == 3) {
            add({vertex(inside[0], outside[0]), vertex(inside[1], outside[0]),
                 vertex(inside[2], outside[0])},
                outward);
        } else {
            const Index a = vertex(inside[0], outside[0]), b = vertex(inside[0], outside[1]),
                        c = vertex(inside[1], outside[1]), d = vertex(inside[1], outside[0]);
            add({a, b, c}, outward);
            add({a, c, d}, outward);
        }
    }

    void add(Triangle t, const Vec3& outward) {
        const Vec3& a = surface.vertices[t[0]];
        const Vec3 normal = (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a);
        if (normal.dot(outward) < 0) std::swap(t[1], t[2]);
        surface.triangles.push_back(t);
    }

    Index vertex_on(const Node& node, int inside, int outside) {
        const int from = inside & outside, along = inside ^ outside;
        const std::uint64_t key = std::uint64_t(offset(node, from)) * 8 + std::uint64_t(along);
        const auto [entry, is_new] = number_.try_emplace(key, Index(surface.vertices.size()));
        if (is_new) {
            edges_.push_back({point(node, inside), point(node, outside),
                              samples_[offset(node, inside)], samples_[offset(node, outside)]});
            surface.vertices.push_back(point_on(edges_.back(), linear_zero(edges_.back())));
        }
        return entry->second;
    }

    /// Fraction of an edge from inside to outside; never an end, so that no triangle collapses.
    static double linear_zero(const Edge& e) {
        const double t = e.value_inside / (e.value_inside - e.value_outside);
        return std::clamp(t, 0.002, 0.998);
    }

    static Vec3 point_on(const Edge& e, double t) { return e.inside + t * (e.outside - e.inside); }

    static Vec3 zero_on_edge(const Edge& edge, const std::function<double(const Vec3&)>& function) {
        double low = 0, high = 1, f_low = edge.value_inside, f_high = edge.value_outside;
        double t = linear_zero(edge);
        for (int step = 0; step < 2; ++step) {
            const double f = function(point_on(edge, t));
            (f < 0 ? low : high) = t;
            (f < 0 ? f_low : f_high) = f;
            t = low + (high - low) * f_low / (f_low - f_high);
        }
        return point_on(edge, std::clamp(t, 0.002, 0.998));
    }

    std::size_t offset(const Node& n, int corner) const {
        return grid_.offset(n[0] + (corner & 1), n[1] + (corner >> 1 & 1), n[2] + (corner >> 2));
    }
    Vec3 point(const Node& n, int corner) const {
        return grid_.to_point(
            Vec3(n[0] + (corner & 1), n[1] + (corner >> 1 & 1), n[2] + (corner >> 2)));
    }

    const ImageGrid& grid_;
    const std::vector<float>& samples_;
    std::vector<Edge> edges_;  ///< per vertex
    std::unordered_map<std::uint64_t, Index> number_;
};

}  // namespace

Surface zero_level(const ImageGrid& grid, const std::vector<float>& samples,
                   const std::function<double(const Vec3&)>& function) {
    MarchingTets tets_of_grid(grid, samples);
    tets_of_grid.march();
    tets_of_grid.refine(function);
    return std::move(tets_of_grid.surface);
}

}  // namespace palpate

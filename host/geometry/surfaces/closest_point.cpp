// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/closest_point.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {

Vec3 closest_point_of_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3 bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return a + d1 / (d1 - d3) * ab;
    const Vec3 cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6 && (d4 - d3) + (d5 - d6) > 0) {
        return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    }
    const double sum = va + vb + vc;
    if (!(sum > 0)) return a;  // a triangle without area, reached only by rounding
    return a + vb / sum * ab + vc / sum * ac;
}

/// Bounding boxes of triangles, halved at the median of the longest side.
struct ClosestPointQuery::Tree {
    struct Node {
        Vec3 low, high;
        Index first = 0, count = 0;  ///< triangles in `order` of a leaf; count 0: inner node
        Index right = 0;             ///< the left child is the next node
    };
    static constexpr Index leaf_size = 4;

    std::vector<std::array<Vec3, 3>> corners;  ///< in tree order
    std::vector<Index> order, place_of;        ///< triangle of a place in the tree, and back
    std::vector<Node> nodes;

    explicit Tree(const Surface& surface) {
        const Index count = static_cast<Index>(surface.triangles.size());
        if (count == 0) {
            throw Error(ErrorCode::invalid_argument,
                        "closest points need a surface with at least one triangle");
        }
        order.resize(count);
        std::iota(order.begin(), order.end(), 0);
        std::vector<Vec3> centres(count);
        for (Index t = 0; t < count; ++t) {
            const Triangle& v = surface.triangles[t];
            centres[t] =
                (surface.vertices[v[0]] + surface.vertices[v[1]] + surface.vertices[v[2]]) / 3;
        }
        nodes.reserve(2 * std::size_t(count) / leaf_size + 2);
        build(surface, centres, 0, count);
        corners.reserve(count);
        place_of.resize(count);
        for (Index t : order) {
            place_of[t] = static_cast<Index>(corners.size());
            const Triangle& v = surface.triangles[t];
            corners.push_back(
                {surface.vertices[v[0]], surface.vertices[v[1]], surface.vertices[v[2]]});
        }
    }

    Index build(const Surface& surface, const std::vector<Vec3>& centres, Index begin, Index end) {
        const Index number = static_cast<Index>(nodes.size());
        nodes.emplace_back();
        Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (Index n = begin; n < end; ++n) {
            for (Index vertex : surface.triangles[order[n]]) {
                low = low.cwiseMin(surface.vertices[vertex]);
                high = high.cwiseMax(surface.vertices[vertex]);
            }
        }
        nodes[number].low = low;
        nodes[number].high = high;
        if (end - begin <= leaf_size) {
            nodes[number].first = begin;
            nodes[number].count = end - begin;
            return number;
        }
        int axis = 0;
        (high - low).maxCoeff(&axis);
        const Index middle = begin + (end - begin) / 2;
        std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                         [&](Index s, Index t) { return centres[s][axis] < centres[t][axis]; });
        build(surface, centres, begin, middle);
        const Index right = build(surface, centres, middle, end);
        nodes[number].right = right;
        return number;
    }

    static double squared_distance(const Node& node, const Vec3& p) {
        return (node.low - p).cwiseMax(p - node.high).cwiseMax(Vec3::Zero()).squaredNorm();
    }

    void try_triangle(const Vec3& p, Index n, double& best, ClosestPoint& result) const {
        const auto& [a, b, c] = corners[n];
        const Vec3 candidate = closest_point_of_triangle(p, a, b, c);
        const double distance = (candidate - p).squaredNorm();
        if (distance < best || result.triangle < 0) {
            best = distance;
            result.point = candidate;
            result.triangle = n;
        }
    }

    /// `hint` is a triangle in tree order that is probably near, or -1.
    ClosestPoint closest(const Vec3& p, Index hint) const {
        if (!p.allFinite()) {
            throw Error(ErrorCode::invalid_argument, "the closest point to a NaN was asked for");
        }
        double best = std::numeric_limits<double>::infinity();
        ClosestPoint result;
        if (hint >= 0) try_triangle(p, hint, best, result);
        struct Entry {
            Index node;
            double distance;
        };
        std::array<Entry, 128> stack;
        int top = 0;
        stack[top++] = {0, squared_distance(nodes[0], p)};
        while (top > 0) {
            const Entry entry = stack[--top];
            if (entry.distance > best) continue;
            const Node& node = nodes[entry.node];
            for (Index n = node.first; n < node.first + node.count; ++n) {
                try_triangle(p, n, best, result);
            }
            if (node.count > 0) continue;
            Entry near{entry.node + 1, squared_distance(nodes[entry.node + 1], p)};
            Entry far{node.right, squared_distance(nodes[node.right], p)};
            if (far.distance < near.distance) std::swap(near, far);
            if (far.distance < best) stack[top++] = far;
            if (near.distance < best) stack[top++] = near;
        }
        result.distance_mm = std::sqrt(best);
        return result;
    }
};

ClosestPointQuery::ClosestPointQuery(const Surface& surface)
    : tree_(std::make_unique<Tree>(surface)) {}
ClosestPointQuery::~ClosestPointQuery() = default;

ClosestPoint ClosestPointQuery::closest(const Vec3& point, Index near_triangle) const {
    const Index hint = near_triangle < 0 ? -1 : tree_->place_of[near_triangle];
    ClosestPoint result = tree_->closest(point, hint);
    result.triangle = tree_->order[result.triangle];
    return result;
}

std::vector<ClosestPoint> ClosestPointQuery::closest(const std::vector<Vec3>& points) const {
    std::vector<ClosestPoint> result(points.size());
    parallel_ranges(points.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            result[n] = closest(points[n], n == begin ? -1 : result[n - 1].triangle);
        }
    });
    return result;
}

SurfaceDistance surface_distance(const Surface& from, const Surface& to) {
    const std::vector<ClosestPoint> closest = ClosestPointQuery(to).closest(from.vertices);
    const std::vector<double> areas = vertex_areas(from);
    const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
    SurfaceDistance result;
    if (!(total > 0)) return result;
    std::vector<Index> by_distance;
    for (Index v = 0; v < Index(areas.size()); ++v) {
        const double distance = closest[v].distance_mm, weight = areas[v] / total;
        if (!(weight > 0)) continue;  // no triangle uses it
        result.mean_mm += weight * distance;
        result.rms_mm += weight * distance * distance;
        result.max_mm = std::max(result.max_mm, distance);
        by_distance.push_back(v);
    }
    result.rms_mm = std::sqrt(result.rms_mm);
    std::sort(by_distance.begin(), by_distance.end(),
              [&](Index a, Index b) { return closest[a].distance_mm < closest[b].distance_mm; });
    double covered = 0;
    for (Index v : by_distance) {
        covered += areas[v] / total;
        result.p95_mm = closest[v].distance_mm;
        if (covered >= 0.95) break;
    }
    return result;
}

}  // namespace palpate

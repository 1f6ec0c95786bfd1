// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/edge_middles.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpate {
namespace {

/// Neighbours farther off the tangent plane than this part of their distance: no smooth surface.
constexpr double most_slope = 0.5;
/// Smallest eigenvalue of sum t t^T over the largest: neighbours to all sides.
constexpr double least_spread = 0.05;

/// Vertices with an edge of one triangle: the rim of an open surface.
std::vector<std::uint8_t> on_rim(const Surface& surface) {
    std::map<std::pair<Index, Index>, int> triangles_at;
    for (const Triangle& triangle : surface.triangles)
        for (int c = 0; c < 3; ++c) {
            const Index p = triangle[c], q = triangle[(c + 1) % 3];
            ++triangles_at[{std::min(p, q), std::max(p, q)}];
        }
    std::vector<std::uint8_t> found(surface.vertices.size(), 0);
    for (const auto& [edge, count] : triangles_at)
        if (count == 1) found[edge.first] = found[edge.second] = 1;
    return found;
}

bool is_spread(const Eigen::Matrix2d& square) {
    const double half = 0.5 * square.trace();
    const double root = std::sqrt(std::max(0.0, half * half - square.determinant()));
    return half - root > least_spread * (half + root);
}

}  // namespace

EdgeMiddles::EdgeMiddles(const Surface& surface, const std::vector<Vec3>& normals)
    : gradient_(surface.vertices.size()), vertices_(surface.vertices) {
    const auto neighbours = vertex_neighbours(surface);
    const auto is_rim = on_rim(surface);
    for (std::size_t v = 0; v < gradient_.size(); ++v) {
        const Vec3 first = normals[v].unitOrthogonal(), second = normals[v].cross(first);
        Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
        std::vector<std::pair<Index, Eigen::Vector2d>> tangential;
        bool is_smooth = !is_rim[v];
        for (const Index other : neighbours[v]) {
            const Vec3 offset = vertices_[other] - vertices_[v];
            tangential.push_back({other, {first.dot(offset), second.dot(offset)}});
            square += tangential.back().second * tangential.back().second.transpose();
            is_smooth &= std::abs(normals[v].dot(offset)) <= most_slope * offset.norm();
        }
        if (!is_smooth || !is_spread(square)) continue;
        const Eigen::Matrix2d inverse = square.inverse();
        for (const auto& [other, t] : tangential) {
            const Eigen::Vector2d along = inverse * t;
            gradient_[v].push_back({other, along[0] * first + along[1] * second});
        }
    }
}

std::vector<VertexWeight> EdgeMiddles::at(Index p, Index q) const {
    std::map<Index, double> weight{{p, 0.5}, {q, 0.5}};
    const Vec3 edge = vertices_[q] - vertices_[p];
    const auto add_slope = [&](Index v, double factor) {
        for (const Neighbour& neighbour : gradient_[v]) {
            const double slope = factor * neighbour.along.dot(edge);
            weight[neighbour.vertex] += slope;
            weight[v] -= slope;
        }
    };
    if (!gradient_[p].empty() && !gradient_[q].empty()) {
        add_slope(p, 0.125);
        add_slope(q, -0.125);
    }
    std::vector<VertexWeight> weights;
    for (const auto& [vertex, part] : weight) weights.push_back({vertex, part});
    return weights;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/surface_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpate {
namespace {

constexpr double most_smoothing_steps = 500;

/// Edges of one triangle only.
std::vector<std::array<bool, 3>> rim_edges(const Surface& surface) {
    std::map<std::pair<Index, Index>, int> uses;
    const auto edge = [](const Triangle& t, int opposite) {
        return std::minmax(t[(opposite + 1) % 3], t[(opposite + 2) % 3]);
    };
    for (const Triangle& t : surface.triangles) {
        for (int c = 0; c < 3; ++c) ++uses[edge(t, c)];
    }
    std::vector<std::array<bool, 3>> rim;
    for (const Triangle& t : surface.triangles) {
        rim.push_back({uses[edge(t, 0)] == 1, uses[edge(t, 1)] == 1, uses[edge(t, 2)] == 1});
    }
    return rim;
}

/// Means of a vertex and its neighbours, over and over: a random walk of n steps of length h
/// spreads along the surface by a standard deviation of h sqrt(n / 2) along each of two axes.
std::vector<Vec3> smoothed(const Surface& surface, std::vector<Vec3> normals) {
    double squares = 0;
    for (const Triangle& t : surface.triangles) {
        for (int c = 0; c < 3; ++c)
            squares += (surface.vertices[t[c]] - surface.vertices[t[(c + 1) % 3]]).squaredNorm();
    }
    const double step_mm2 = squares / (3.0 * double(surface.triangles.size()));
    const double wanted = 2.0 * normal_smoothing_mm * normal_smoothing_mm / step_mm2;
    const int steps = static_cast<int>(std::clamp(std::round(wanted), 0.0, most_smoothing_steps));
    for (int k = 0; k < steps; ++k) {
        std::vector<Vec3> sum(normals.size(), Vec3::Zero());
        for (const Triangle& t : surface.triangles) {
            const Vec3 all = normals[t[0]] + normals[t[1]] + normals[t[2]];
            for (const Index corner : t) sum[corner] += all - normals[corner];
        }
        for (std::size_t v = 0; v < normals.size(); ++v)
            if (sum[v].squaredNorm() > 0) normals[v] = sum[v].normalized();
    }
    return normals;
}

}  // namespace

SurfaceShape::SurfaceShape(Surface surface)
    : surface_(std::move(surface)),
      query_(surface_),
      vertex_normals_(vertex_normals(surface_)),
      smooth_normals_(smoothed(surface_, vertex_normals_)),
      is_rim_(rim_edges(surface_)) {}

/// Barycentric coordinates of a point of the triangle's plane.
Vec3 SurfaceShape::weights(const Vec3& point, const Triangle& corners) const {
    const Vec3& a = surface_.vertices[corners[0]];
    const Vec3 u = surface_.vertices[corners[1]] - a, v = surface_.vertices[corners[2]] - a;
    const Vec3 w = point - a, normal = u.cross(v);
    const double scale = 1.0 / normal.squaredNorm();
    const double second = w.cross(v).dot(normal) * scale;
    const double third = u.cross(w).dot(normal) * scale;
    return {1.0 - second - third, second, third};
}

bool SurfaceShape::on_rim(Index triangle, const Vec3& weights) const {
    for (int c = 0; c < 3; ++c) {
        if (is_rim_[triangle][c] && weights[c] < 1e-6) return true;
    }
    return false;
}

SurfaceShape::Distance SurfaceShape::distance(const Vec3& point) const {
    const ClosestPoint closest = query_.closest(point);
    const Vec3 weight = weights(closest.point, surface_.triangles[closest.triangle]);
    return {closest.distance_mm, on_rim(closest.triangle, weight)};
}

ShapeDistance SurfaceShape::measure(const Vec3& point, const Vec3& facing) const {
    const ClosestPoint closest = query_.closest(point);
    const Triangle& corners = surface_.triangles[closest.triangle];
    const Vec3 weight = weights(closest.point, corners);
    Vec3 normal = Vec3::Zero(), smooth = Vec3::Zero();
    for (int c = 0; c < 3; ++c) {
        normal += weight[c] * vertex_normals_[corners[c]];
        smooth += weight[c] * smooth_normals_[corners[c]];
    }
    normal.normalize();
    const bool is_seen = !on_rim(closest.triangle, weight) && face_alike(normal, facing);
    return {normal.dot(point - closest.point), normal, is_seen, smooth.normalized()};
}

}  // namespace palpate

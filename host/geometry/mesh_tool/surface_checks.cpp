// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/surface_checks.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

namespace {

constexpr double max_coordinate_mm = 1e6;
constexpr double min_relative_area = 1e-8;  ///< of the square of the longest edge
constexpr Index max_region = 65535;

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorCode::mesh_failed, "the surface cannot be meshed: " + why);
}

void check_vertices(const std::vector<Vec3>& vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if (!vertices[i].allFinite() || vertices[i].cwiseAbs().maxCoeff() > max_coordinate_mm)
            refuse("vertex " + std::to_string(i) + " is not finite or out of range");
    std::vector<std::tuple<double, double, double>> sorted;
    sorted.reserve(vertices.size());
    for (const Vec3& v : vertices) sorted.emplace_back(v.x(), v.y(), v.z());
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
        refuse("two vertices lie at the same place");
}

void check_triangle(const SurfaceJob& job, std::size_t i) {
    const Triangle& triangle = job.triangles[i];
    const std::string name = "triangle " + std::to_string(i);
    for (Index v : triangle)
        if (v < 0 || v >= static_cast<Index>(job.vertices.size()))
            refuse(name + " has the vertex number " + std::to_string(v) + ", which does not exist");
    const auto& [behind, front] = job.regions[i];
    if (behind < 0 || front < 0 || behind > max_region || front > max_region || behind == front)
        refuse(name + " lies between regions " + std::to_string(behind) + " and " +
               std::to_string(front));
    const Vec3 a = job.vertices[triangle[1]] - job.vertices[triangle[0]];
    const Vec3 b = job.vertices[triangle[2]] - job.vertices[triangle[0]];
    const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
    if (a.cross(b).norm() <= min_relative_area * longest) refuse(name + " has no area");
}

void check_no_triangle_twice(const std::vector<Triangle>& triangles) {
    std::vector<Triangle> sorted = triangles;
    for (Triangle& triangle : sorted) std::sort(triangle.begin(), triangle.end());
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
        refuse("a triangle is given twice");
}

/// Along each edge the oriented triangles of a region must cancel, else its surface is open there.
void check_regions_closed(const SurfaceJob& job) {
    struct Edge {
        Index region, from, to;
        int sign;
        bool operator<(const Edge& o) const {
            return std::tie(region, from, to) < std::tie(o.region, o.from, o.to);
        }
    };
    std::vector<Edge> edges;
    edges.reserve(job.triangles.size() * 6);
    for (std::size_t i = 0; i < job.triangles.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            const Index a = job.triangles[i][k], b = job.triangles[i][(k + 1) % 3];
            const int sign = a < b ? 1 : -1;
            edges.push_back({job.regions[i][0], std::min(a, b), std::max(a, b), sign});
            edges.push_back({job.regions[i][1], std::min(a, b), std::max(a, b), -sign});
        }
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size();) {
        int sum = 0;
        std::size_t j = i;
        for (; j < edges.size() && !(edges[i] < edges[j]); ++j) sum += edges[j].sign;
        if (sum != 0)
            refuse("the surface of region " + std::to_string(edges[i].region) + " is open");
        i = j;
    }
}

void check_regions_turned_outward(const SurfaceJob& job) {
    std::map<Index, double> volume;
    for (std::size_t i = 0; i < job.triangles.size(); ++i) {
        const Triangle& t = job.triangles[i];
        const double part = tet_volume(job.vertices[job.triangles[0][0]], job.vertices[t[0]],
                                       job.vertices[t[1]], job.vertices[t[2]]);
        volume[job.regions[i][0]] += part;
        volume[job.regions[i][1]] -= part;
    }
    for (const auto& [region, mm3] : volume)
        if (region != 0 && !(mm3 > 0))
            refuse("region " + std::to_string(region) + " has no volume or is inside out");
}

}  // namespace

void check_surface(const SurfaceJob& job) {
    if (job.vertices.empty() || job.triangles.empty()) refuse("it is empty");
    if (job.regions.size() != job.triangles.size()) refuse("not every triangle has its regions");
    check_vertices(job.vertices);
    for (std::size_t i = 0; i < job.triangles.size(); ++i) check_triangle(job, i);
    check_no_triangle_twice(job.triangles);
    check_regions_closed(job);
    check_regions_turned_outward(job);
}

}  // namespace palpate::mesh_tool

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/surface.hpp"

#include <Eigen/Geometry>
#include <utility>

namespace palpate {

Surface surface_of_region(const RegionSurface& all, Index region, bool include_border,
                          std::vector<Index>* vertex_of) {
    Surface surface;
    std::vector<Index> number(all.vertices.size(), -1);
    if (vertex_of) vertex_of->clear();
    for (Index t = 0; t < all.num_triangles(); ++t) {
        const bool behind = all.regions[t][0] == region, in_front = all.regions[t][1] == region;
        if (behind == in_front) continue;
        if (!include_border && all.on_image_border[t]) continue;
        Triangle triangle = all.triangles[t];
        if (in_front) std::swap(triangle[1], triangle[2]);
        for (Index& vertex : triangle) {
            if (number[vertex] < 0) {
                number[vertex] = static_cast<Index>(surface.vertices.size());
                surface.vertices.push_back(all.vertices[vertex]);
                if (vertex_of) vertex_of->push_back(vertex);
            }
            vertex = number[vertex];
        }
        surface.triangles.push_back(triangle);
    }
    return surface;
}

double enclosed_volume(const Surface& surface) {
    if (surface.vertices.empty()) return 0;
    const Vec3 origin = surface.vertices.front();  // near the surface: less cancellation
    double volume = 0;
    for (const Triangle& t : surface.triangles) {
        const Vec3 a = surface.vertices[t[0]] - origin, b = surface.vertices[t[1]] - origin,
                   c = surface.vertices[t[2]] - origin;
        volume += a.dot(b.cross(c)) / 6;
    }
    return volume;
}

namespace {

double triangle_area(const Surface& surface, const Triangle& t) {
    const Vec3& a = surface.vertices[t[0]];
    return 0.5 * (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a).norm();
}

}  // namespace

double surface_area(const Surface& surface) {
    double area = 0;
    for (const Triangle& t : surface.triangles) area += triangle_area(surface, t);
    return area;
}

std::vector<double> vertex_areas(const Surface& surface) {
    std::vector<double> areas(surface.vertices.size(), 0.0);
    for (const Triangle& t : surface.triangles) {
        const double third = triangle_area(surface, t) / 3;
        for (const Index vertex : t) areas[vertex] += third;
    }
    return areas;
}

std::vector<std::set<Index>> vertex_neighbours(const Surface& surface) {
    std::vector<std::set<Index>> neighbours(surface.vertices.size());
    for (const Triangle& triangle : surface.triangles)
        for (int c = 0; c < 3; ++c) {
            const Index p = triangle[c], q = triangle[(c + 1) % 3];
            neighbours[p].insert(q);
            neighbours[q].insert(p);
        }
    return neighbours;
}

std::vector<Vec3> vertex_normals(const Surface& surface) {
    std::vector<Vec3> normals(surface.vertices.size(), Vec3::Zero());
    for (const Triangle& t : surface.triangles) {
        const Vec3& a = surface.vertices[t[0]];
        const Vec3 normal = (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a);
        for (const Index corner : t) normals[corner] += normal;
    }
    for (Vec3& normal : normals) normal.normalize();
    return normals;
}

}  // namespace palpate

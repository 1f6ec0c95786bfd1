// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/meshing/test_surfaces.hpp"

#include <cmath>
#include <map>
#include <tuple>

#include "host/io/label_image.hpp"

namespace palpate::testing {

namespace {

void add_triangle(RegionSurface& surface, const Triangle& triangle, Index behind, Index front,
                  bool on_border) {
    surface.triangles.push_back(triangle);
    surface.regions.push_back({behind, front});
    surface.on_image_border.push_back(on_border);
}

Surface icosahedron() {
    const double g = (1 + std::sqrt(5.0)) / 2;
    Surface s;
    s.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                  {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    s.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    return s;
}

Surface divided(const Surface& s) {
    Surface fine;
    fine.vertices = s.vertices;
    std::map<std::pair<Index, Index>, Index> middle;
    const auto mid = [&](Index a, Index b) {
        const auto [entry, fresh] = middle.emplace(std::minmax(a, b), fine.vertices.size());
        if (fresh) fine.vertices.push_back((s.vertices[a] + s.vertices[b]) / 2);
        return entry->second;
    };
    for (const auto& [a, b, c] : s.triangles) {
        const Index ab = mid(a, b), bc = mid(b, c), ca = mid(c, a);
        fine.triangles.insert(fine.triangles.end(),
                              {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    return fine;
}

/// The vertex at a point, found by its rounded coordinates so that neighbours share it.
class VertexOf {
public:
    explicit VertexOf(RegionSurface& surface) : surface_(surface) {}
    Index operator()(const Vec3& p) {
        const auto key = std::tuple(std::lround(p.x() * 1e4), std::lround(p.y() * 1e4),
                                    std::lround(p.z() * 1e4));
        const auto [entry, fresh] = known_.emplace(key, surface_.vertices.size());
        if (fresh) surface_.vertices.push_back(p);
        return entry->second;
    }

private:
    RegionSurface& surface_;
    std::map<std::tuple<long, long, long>, Index> known_;
};

/// One wall of a box: `axis` is constant, the normal points to the high or the low side.
void add_wall(RegionSurface& surface, VertexOf& vertex, const Vec3& low, const Vec3& high,
              const std::array<int, 3>& cells, int axis, bool at_high, Index behind, Index front) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto corner = [&](int i, int j) {
        Vec3 p;
        p[axis] = at_high ? high[axis] : low[axis];
        p[u] = low[u] + (high[u] - low[u]) * i / cells[u];
        p[v] = low[v] + (high[v] - low[v]) * j / cells[v];
        return vertex(p);
    };
    const bool border = behind == outside_region || front == outside_region;
    for (int i = 0; i < cells[u]; ++i)
        for (int j = 0; j < cells[v]; ++j) {
            const Index a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1),
                        d = corner(i, j + 1);
            const bool turn = !at_high;
            add_triangle(surface, turn ? Triangle{a, c, b} : Triangle{a, b, c}, behind, front,
                         border);
            add_triangle(surface, turn ? Triangle{a, d, c} : Triangle{a, c, d}, behind, front,
                         border);
        }
}

}  // namespace

void add_sphere(RegionSurface& surface, const Vec3& centre, double radius, int level, Index inside,
                Index around) {
    Surface sphere = icosahedron();
    for (int i = 0; i < level; ++i) {
        sphere = divided(sphere);
        for (Vec3& v : sphere.vertices) v.normalize();
    }
    const Index first = static_cast<Index>(surface.vertices.size());
    for (const Vec3& v : sphere.vertices)
        surface.vertices.push_back(centre + radius * v.normalized());
    for (const auto& [a, b, c] : sphere.triangles)
        add_triangle(surface, {a + first, b + first, c + first}, inside, around, false);
}

void add_box(RegionSurface& surface, const Vec3& low, const Vec3& high, std::array<int, 3> cells,
             Index inside, Index around) {
    VertexOf vertex(surface);
    for (int axis = 0; axis < 3; ++axis)
        for (bool at_high : {false, true})
            add_wall(surface, vertex, low, high, cells, axis, at_high, inside, around);
}

RegionSurface touching_boxes(const std::vector<Index>& regions, int cells, double side_mm) {
    RegionSurface surface;
    VertexOf vertex(surface);
    const std::array<int, 3> n{cells, cells, cells};
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Vec3 low(side_mm * static_cast<double>(i), 0, 0);
        const Vec3 high = low + Vec3::Constant(side_mm);
        const Index next = i + 1 < regions.size() ? regions[i + 1] : outside_region;
        if (i == 0) add_wall(surface, vertex, low, high, n, 0, false, regions[i], outside_region);
        add_wall(surface, vertex, low, high, n, 0, true, regions[i], next);
        for (int axis : {1, 2})
            for (bool at_high : {false, true})
                add_wall(surface, vertex, low, high, n, axis, at_high, regions[i], outside_region);
    }
    return surface;
}

RegionSurface sphere_pelvis(int level) {
    RegionSurface surface;
    add_box(surface, Vec3::Zero(), Vec3::Constant(120), {10, 10, 10}, 1, outside_region);
    add_sphere(surface, {60, 55, 45}, 18, level, 2, 1);
    add_sphere(surface, {60, 55, 45}, 8, level - 1, 5, 2);
    add_sphere(surface, {60, 50, 88}, 23, level, 3, 1);
    add_sphere(surface, {60, 92, 50}, 16, level, 4, 1);
    return surface;
}

}  // namespace palpate::testing

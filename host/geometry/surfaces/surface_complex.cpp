// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/surface_complex.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate {

void LabelSet::insert(std::uint8_t label) {
    const auto end = labels.begin() + count;
    const auto place = std::lower_bound(labels.begin(), end, label);
    if ((place != end && *place == label) || count == int(labels.size())) return;
    std::move_backward(place, end, end + 1);
    *place = label;
    ++count;
}

void SurfaceComplex::connect() {
    faces_of.assign(points.size(), {});
    for (std::size_t f = 0; f < faces.size(); ++f)
        if (faces[f].is_alive())
            for (Index v : faces[f].v) faces_of[v].push_back(Index(f));
}

void SurfaceComplex::compact() {
    std::vector<Index> number(points.size(), -1);
    SurfaceComplex kept;
    for (Face face : faces) {
        if (!face.is_alive()) continue;
        for (Index& v : face.v) {
            if (number[v] < 0) {
                number[v] = Index(kept.points.size());
                kept.points.push_back(points[v]);
                kept.planes.push_back(planes[v]);
            }
            v = number[v];
        }
        kept.faces.push_back(face);
    }
    kept.connect();
    *this = std::move(kept);
}

Vec3 SurfaceComplex::area_vector(const Face& face) const {
    const Vec3& a = points[face.v[0]];
    return (points[face.v[1]] - a).cross(points[face.v[2]] - a);
}

Vec3 SurfaceComplex::area_vector(const Face& face, Index moved, const Vec3& to) const {
    const Vec3& a = face.v[0] == moved ? to : points[face.v[0]];
    const Vec3& b = face.v[1] == moved ? to : points[face.v[1]];
    const Vec3& c = face.v[2] == moved ? to : points[face.v[2]];
    return (b - a).cross(c - a);
}

int SurfaceComplex::edge_faces(Index u, Index v, std::array<Index, 8>& found) const {
    int count = 0;
    for (Index f : faces_of[u])
        if (faces[f].has(v) && count < int(found.size())) found[count++] = f;
    return count;
}

bool SurfaceComplex::is_feature(Index u, Index v) const {
    std::array<Index, 8> found;
    return edge_faces(u, v, found) != 2 || faces[found[0]].plane != faces[found[1]].plane;
}

SurfaceComplex::Kind SurfaceComplex::kind(Index vertex, FeatureNeighbours* along) const {
    struct Neighbour {
        Index vertex;
        int faces;
        std::int8_t plane;
        bool bends;
    };
    thread_local std::vector<Neighbour> around;
    around.clear();
    for (Index f : faces_of[vertex])
        for (Index v : faces[f].v) {
            if (v == vertex) continue;
            const auto known = std::find_if(around.begin(), around.end(),
                                            [&](const Neighbour& n) { return n.vertex == v; });
            if (known == around.end()) {
                around.push_back({v, 1, faces[f].plane, false});
            } else {
                ++known->faces;
                known->bends |= known->plane != faces[f].plane;
            }
        }
    int features = 0;
    for (const Neighbour& n : around) {
        if (n.faces == 2 && !n.bends) continue;
        if (along && along->count < 8) along->vertices[along->count++] = n.vertex;
        ++features;
    }
    return features == 0 ? Kind::surface : features == 2 ? Kind::curve : Kind::corner;
}

LabelSet SurfaceComplex::labels_at(Index vertex) const {
    LabelSet set;
    for (Index f : faces_of[vertex])
        for (std::uint8_t label : faces[f].regions)
            if (label != beyond_box) set.insert(label);
    return set;
}

unsigned SurfaceComplex::fixed_axes(Index vertex) const {
    unsigned axes = 0;
    for (unsigned axis = 0; axis < 3; ++axis)
        if (planes[vertex] >> (2 * axis) & 3u) axes |= 1u << axis;
    return axes;
}

std::vector<std::array<Index, 2>> SurfaceComplex::edges() const {
    std::vector<std::array<Index, 2>> all;
    all.reserve(faces.size() * 3);
    for (const Face& face : faces)
        if (face.is_alive())
            for (int corner = 0; corner < 3; ++corner) {
                const Index u = face.v[corner], v = face.v[(corner + 1) % 3];
                all.push_back({std::min(u, v), std::max(u, v)});
            }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

SurfaceComplex boundary_of(const LabelLattice& lattice) {
    SurfaceComplex complex;
    const auto& n = lattice.size;
    const std::array<std::size_t, 3> stride{1, std::size_t(n[0] + 1),
                                            std::size_t(n[0] + 1) * std::size_t(n[1] + 1)};
    std::vector<Index> number(stride[2] * std::size_t(n[2] + 1), -1);
    const auto vertex = [&](const std::array<Index, 3>& corner) {
        Index& known = number[corner[0] + stride[1] * corner[1] + stride[2] * corner[2]];
        if (known >= 0) return known;
        known = Index(complex.points.size());
        unsigned planes = 0;
        Vec3 point;
        for (unsigned axis = 0; axis < 3; ++axis) {
            point[axis] = corner[axis] * lattice.spacing[axis];
            if (corner[axis] == 0) planes |= 1u << (2 * axis);
            if (corner[axis] == n[axis]) planes |= 2u << (2 * axis);
        }
        complex.points.push_back(point);
        complex.planes.push_back(std::uint8_t(planes));
        return known;
    };
    for (int axis = 0; axis < 3; ++axis) {
        const int side = (axis + 1) % 3, up = (axis + 2) % 3;
        std::array<Index, 3> last = n;
        last[axis] += 1;
        std::array<Index, 3> c;  // the square's lowest corner; cells c - axis and c share it
        for (c[2] = 0; c[2] < last[2]; ++c[2])
            for (c[1] = 0; c[1] < last[1]; ++c[1])
                for (c[0] = 0; c[0] < last[0]; ++c[0]) {
                    std::array<Index, 3> before = c;
                    --before[axis];
                    const std::uint8_t behind = lattice.at(before[0], before[1], before[2]);
                    const std::uint8_t front = lattice.at(c[0], c[1], c[2]);
                    if (behind == front) continue;
                    std::array<std::array<Index, 3>, 4> square{c, c, c, c};
                    ++square[1][side], ++square[2][side], ++square[2][up], ++square[3][up];
                    std::array<Index, 4> q;
                    for (int corner = 0; corner < 4; ++corner) q[corner] = vertex(square[corner]);
                    const int plane = c[axis] == 0         ? 2 * axis
                                      : c[axis] == n[axis] ? 2 * axis + 1
                                                           : -1;
                    const int turn = (c[side] + c[up]) & 1;  // alternate diagonals
                    const Index a = q[turn], b = q[turn + 1], c2 = q[turn + 2],
                                d = q[(turn + 3) % 4];
                    const auto add = [&](Index x, Index y, Index z) {
                        SurfaceComplex::Face face{{x, y, z}, {behind, front}, std::int8_t(plane)};
                        if (behind > front) face = {{x, z, y}, {front, behind}, face.plane};
                        complex.faces.push_back(face);
                    };
                    add(a, b, c2);
                    add(a, c2, d);
                }
    }
    complex.connect();
    return complex;
}

double largest_cosine(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, bc = c - b, ca = a - c;
    const double la = bc.norm(), lb = ca.norm(), lc = ab.norm();
    if (la == 0 || lb == 0 || lc == 0) return 1;
    return std::max({-ab.dot(ca) / (lc * lb), -bc.dot(ab) / (la * lc), -ca.dot(bc) / (lb * la)});
}

}  // namespace palpate

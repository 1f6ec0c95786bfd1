// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/collapse_edges.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace palpate {
namespace {

using Face = SurfaceComplex::Face;
using Kind = SurfaceComplex::Kind;

const double tolerable_cosine = std::cos(15 * degree);  // of an angle in a triangle
const double needle_cosine = std::cos(10 * degree);

struct Collapse {
    Index removed, kept;
    Vec3 place;
};

// Link condition for faces and for feature curves.
bool keeps_topology(const SurfaceComplex& complex, Index u, Index v) {
    thread_local std::vector<Index> around_u, around_v, common;
    find_neighbours(complex, u, around_u);
    find_neighbours(complex, v, around_v);
    common.clear();
    std::set_intersection(around_u.begin(), around_u.end(), around_v.begin(), around_v.end(),
                          std::back_inserter(common));
    std::array<Index, 8> found;
    const int count = complex.edge_faces(u, v, found);
    // Link condition (Dey et al. 1999): link(u) and link(v) meet in link(uv) only, that is, common
    // neighbours are those opposite the edge.
    if (int(common.size()) != count) return false;
    for (Index w : common)
        if (complex.is_feature(u, w) && complex.is_feature(v, w)) return false;
    // no face of u may coincide with one of v afterwards
    for (Index f : complex.faces_of[u]) {
        const Face& face = complex.faces[f];
        if (face.has(v)) continue;
        const auto is_common = [&](Index w) {
            return w == u || std::binary_search(common.begin(), common.end(), w);
        };
        if (std::all_of(face.v.begin(), face.v.end(), is_common)) return false;
    }
    return true;
}

// An edge between two vertices of one box plane must run in that plane's faces, or the surface
// inside would touch the box.
bool touches_box(const SurfaceComplex& complex, const Face& face, Index removed, Index kept) {
    if (face.plane >= 0) return false;
    for (Index w : face.v) {
        if (w == removed || !(complex.planes[w] & complex.planes[kept])) continue;
        std::array<Index, 8> found;
        int count = complex.edge_faces(removed, w, found);
        bool on_plane = false;
        for (int i = 0; i < count; ++i) on_plane |= complex.faces[found[i]].plane >= 0;
        count = complex.edge_faces(kept, w, found);
        for (int i = 0; i < count; ++i) on_plane |= complex.faces[found[i]].plane >= 0;
        if (!on_plane) return true;
    }
    return false;
}

bool keeps_geometry(const RemeshWork& work, const Collapse& collapse) {
    constexpr double tiny = 0.4;
    const SurfaceComplex& complex = work.complex;
    const bool is_tiny = work.length(collapse.removed, collapse.kept) <
                         tiny * work.wanted_at(collapse.removed, collapse.kept);
    // a tiny edge does more harm than the narrow or long faces that its collapse may leave
    // How far faces may turn (73 or 46 degrees), and edges grow over the wanted length.
    const double min_turn_cosine = is_tiny ? 0.3 : 0.7, longest = is_tiny ? 1.8 : 4.0 / 3.0;
    const double max_cosine = is_tiny ? tolerable_cosine : acceptable_cosine;
    for (Index vertex : {collapse.removed, collapse.kept})
        for (Index f : complex.faces_of[vertex]) {
            const Face& face = complex.faces[f];
            if (face.has(collapse.removed) && face.has(collapse.kept)) continue;
            if (!keeps_shape(complex, face, vertex, collapse.place, min_turn_cosine, max_cosine))
                return false;
            if (vertex == collapse.removed &&
                touches_box(complex, face, collapse.removed, collapse.kept))
                return false;
            for (Index w : face.v)
                if (w != vertex && (complex.points[w] - collapse.place).norm() >
                                       longest * work.wanted_at(w, collapse.kept))
                    return false;
        }
    return true;
}

void apply(SurfaceComplex& complex, const Collapse& collapse) {
    const auto forget = [&](Index vertex, Index face) {
        std::erase(complex.faces_of[vertex], face);
    };
    complex.points[collapse.kept] = collapse.place;
    const std::vector<Index> old = std::move(complex.faces_of[collapse.removed]);
    complex.faces_of[collapse.removed].clear();
    for (Index f : old) {
        Face& face = complex.faces[f];
        if (face.has(collapse.kept)) {
            for (Index w : face.v)
                if (w != collapse.removed) forget(w, f);
            face.v[0] = -1;
        } else {
            std::replace(face.v.begin(), face.v.end(), collapse.removed, collapse.kept);
            complex.faces_of[collapse.kept].push_back(f);
        }
    }
}

bool try_collapse(RemeshWork& work, Index u, Index v) {
    SurfaceComplex& complex = work.complex;
    Kind kind_u = complex.kind(u), kind_v = complex.kind(v);
    if (kind_u > kind_v) std::swap(u, v), std::swap(kind_u, kind_v);
    // Surface vertices go into curves and corners, never the other way; curves along themselves.
    if (kind_u == Kind::corner || (kind_u == Kind::curve && !complex.is_feature(u, v)))
        return false;
    if (!keeps_topology(complex, u, v)) return false;
    std::array<Collapse, 3> choices{Collapse{u, v, (complex.points[u] + complex.points[v]) / 2},
                                    Collapse{u, v, complex.points[v]},
                                    Collapse{v, u, complex.points[u]}};
    const bool equals = kind_u == kind_v;
    for (std::size_t i = equals ? 0 : 1; i < (equals ? 3u : 2u); ++i)
        if (keeps_geometry(work, choices[i])) {
            apply(complex, choices[i]);
            return true;
        }
    return false;
}

}  // namespace

bool keeps_shape(const SurfaceComplex& complex, const Face& face, Index moved, const Vec3& to,
                 double min_turn_cosine, double max_cosine) {
    const double old = largest_cosine(complex.points[face.v[0]], complex.points[face.v[1]],
                                      complex.points[face.v[2]]);
    std::array<Vec3, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = face.v[i] == moved ? to : complex.points[face.v[i]];
    const double cosine = largest_cosine(p[0], p[1], p[2]);
    const Vec3 before = complex.area_vector(face), after = complex.area_vector(face, moved, to);
    // the normal of a needle says nothing; wedges between faces are looked at besides
    const bool is_needle = old > needle_cosine && face.plane < 0;
    // n' . n > cos(largest turn), n the area vectors
    if (!is_needle && !(after.dot(before) > min_turn_cosine * after.norm() * before.norm()))
        return false;
    // No angle below the least allowed one, or at least none sharper than before.
    return cosine <= std::max(max_cosine, old);
}

void find_neighbours(const SurfaceComplex& complex, Index vertex, std::vector<Index>& around) {
    around.clear();
    for (Index f : complex.faces_of[vertex])
        for (Index v : complex.faces[f].v)
            if (v != vertex) around.push_back(v);
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
}

void collapse_short_edges(RemeshWork& work, double shortest) {
    std::vector<std::pair<double, std::array<Index, 2>>> edges;
    for (const auto& [u, v] : work.complex.edges()) {
        const double ratio = work.length(u, v) / work.wanted_at(u, v);
        // Shortest first, so that one collapse saves its neighbours from the next.
        if (ratio < shortest) edges.push_back({ratio, {u, v}});
    }
    std::sort(edges.begin(), edges.end());
    for (const auto& [ratio, edge] : edges) {
        const auto [u, v] = edge;
        std::array<Index, 8> found;
        if (work.complex.edge_faces(u, v, found) == 0) continue;
        if (work.length(u, v) < shortest * work.wanted_at(u, v)) try_collapse(work, u, v);
    }
}

}  // namespace palpate

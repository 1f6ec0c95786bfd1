// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/remesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/geometry/surfaces/collapse_edges.hpp"

namespace palpate {
namespace {

using Face = SurfaceComplex::Face;
using Kind = SurfaceComplex::Kind;

const double acceptable_wedge_cosine = std::cos(35 * degree);  // between faces at an edge

// Cosine of the sharpest angle between two faces at the edge (u, v), seen across the edge.
double sharpest_wedge(const SurfaceComplex& complex, Index u, Index v) {
    std::array<Index, 8> found;
    const int count = complex.edge_faces(u, v, found);
    const Vec3 along = (complex.points[v] - complex.points[u]).normalized();
    std::array<Vec3, 8> side;
    for (int i = 0; i < count; ++i)
        for (Index w : complex.faces[found[i]].v)
            if (w != u && w != v) {
                const Vec3 reach = complex.points[w] - complex.points[u];
                // (w - u) - t t . (w - u): the face's direction away from the edge, t along the
                // edge
                side[i] = (reach - along * along.dot(reach)).normalized();
            }
    double cosine = -1;
    for (int i = 0; i < count; ++i)
        for (int j = 0; j < i; ++j) cosine = std::max(cosine, side[i].dot(side[j]));
    return cosine;
}

// The sharpest wedge at the edges of a vertex's faces, with the vertex where it is.
double sharpest_wedge_around(const SurfaceComplex& complex, Index vertex) {
    double cosine = -1;
    for (Index f : complex.faces_of[vertex]) {
        const auto& v = complex.faces[f].v;
        for (int corner = 0; corner < 3; ++corner)
            cosine = std::max(cosine, sharpest_wedge(complex, v[corner], v[(corner + 1) % 3]));
    }
    return cosine;
}

// Whether all faces of a vertex lie on one plane of the box: then nothing can get sharp.
bool is_on_flat_face(const SurfaceComplex& complex, Index vertex) {
    const auto& faces = complex.faces_of[vertex];
    const std::int8_t plane = complex.faces[faces.front()].plane;
    return plane >= 0 && std::all_of(faces.begin(), faces.end(),
                                     [&](Index f) { return complex.faces[f].plane == plane; });
}

// Moves a vertex as far along the way as all its faces allow.
void move_guarded(SurfaceComplex& complex, Index vertex, const Vec3& to) {
    constexpr double min_turn_cosine = 0.5;
    const Vec3 from = complex.points[vertex];
    const bool may_get_sharp = !is_on_flat_face(complex, vertex);
    const double wedge =
        may_get_sharp ? std::max(sharpest_wedge_around(complex, vertex), acceptable_wedge_cosine)
                      : 1;
    // x + a (to - x), a = 1, 1/2, 1/4: the first that neither turns nor sharpens a face
    for (double share : {1.0, 0.5, 0.25}) {
        const Vec3 place = from + share * (to - from);
        const auto fine = [&](Index f) {
            return keeps_shape(complex, complex.faces[f], vertex, place, min_turn_cosine);
        };
        if (std::all_of(complex.faces_of[vertex].begin(), complex.faces_of[vertex].end(), fine)) {
            complex.points[vertex] = place;
            if (!may_get_sharp || sharpest_wedge_around(complex, vertex) <= wedge) return;
            complex.points[vertex] = from;
        }
    }
}

// The middle of the surroundings of a vertex: of its neighbours along feature curves, or of its
// faces (area weighted) on a surface, there taken back into the tangent line or plane.
Vec3 evened_out(const SurfaceComplex& complex, Index vertex, bool tangential) {
    SurfaceComplex::FeatureNeighbours along;
    const Vec3 from = complex.points[vertex];
    const Kind kind = complex.kind(vertex, &along);
    if (kind != Kind::surface) {
        Vec3 middle = Vec3::Zero();
        for (int i = 0; i < along.count; ++i) middle += complex.points[along.vertices[i]];
        // Umbrella operator along the curve: the mean of the neighbours minus the vertex.
        const Vec3 step = middle / along.count - from;
        if (!tangential || kind == Kind::corner) return from + step;
        const Vec3 line = complex.points[along.vertices[1]] - complex.points[along.vertices[0]];
        const double length = line.squaredNorm();
        // Only the part of the step along the tangent t: x + t (t . step) / t . t
        return length > 0 ? Vec3(from + line * (step.dot(line) / length)) : from;
    }
    Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
    double weight = 0;
    for (Index f : complex.faces_of[vertex]) {
        const Face& face = complex.faces[f];
        const Vec3 area = complex.area_vector(face);
        const double size = area.norm();
        // sum A_f c_f / sum A_f, c_f the middle of a face, A_f its area: even sizes (Botsch and
        // Kobbelt 2004, A remeshing approach to multiresolution modeling).
        sum += size / 3 *
               (complex.points[face.v[0]] + complex.points[face.v[1]] + complex.points[face.v[2]]);
        weight += size;
        // all faces of a surface vertex lie between the same two regions: orient them alike
        normal += area;
    }
    if (weight == 0) return from;
    Vec3 step = sum / weight - from;
    if (tangential && normal.squaredNorm() > 0) {
        normal.normalize();
        // (1 - n n^T) step, n the area-weighted normal: along the surface, which keeps its shape
        step -= normal * normal.dot(step);
    }
    return from + step;
}

Vec3 keep_on_planes(const SurfaceComplex& complex, Index vertex, Vec3 to) {
    const unsigned fixed = complex.fixed_axes(vertex);
    for (int axis = 0; axis < 3; ++axis)
        // What lies on planes of the box stays on them.
        if (fixed >> axis & 1u) to[axis] = complex.points[vertex][axis];
    return to;
}

void split(RemeshWork& work, Index u, Index v) {
    SurfaceComplex& complex = work.complex;
    std::array<Index, 8> found;
    const int count = complex.edge_faces(u, v, found);
    const Index middle = Index(complex.points.size());
    complex.points.push_back((complex.points[u] + complex.points[v]) / 2);
    // The middle lies on those planes that hold both ends.
    complex.planes.push_back(complex.planes[u] & complex.planes[v]);
    complex.faces_of.emplace_back();
    work.wanted.push_back(work.wanted_at(u, v));
    for (int i = 0; i < count; ++i) {
        const Index old = found[i], added = Index(complex.faces.size());
        // (u, v, w) becomes (m, v, w) and (u, m, w), which keeps the side of the face.
        Face half = complex.faces[old];
        for (Index& w : half.v)
            if (w == u) w = middle;
        for (Index& w : complex.faces[old].v)
            if (w == v) w = middle;
        complex.faces.push_back(half);
        std::replace(complex.faces_of[v].begin(), complex.faces_of[v].end(), old, added);
        for (Index w : half.v)
            if (w != middle && w != v) complex.faces_of[w].push_back(added);
        complex.faces_of[middle].push_back(old);
        complex.faces_of[middle].push_back(added);
    }
}

void split_long_edges(RemeshWork& work) {
    constexpr double longest = 4.0 / 3.0;
    std::vector<std::pair<double, std::array<Index, 2>>> edges;
    for (const auto& [u, v] : work.complex.edges()) {
        const double ratio = work.length(u, v) / work.wanted_at(u, v);
        // Above 4/3 of the wanted length two halves come closer to it than the whole (Botsch and
        // Kobbelt 2004); longest first.
        if (ratio > longest) edges.push_back({-ratio, {u, v}});
    }
    std::sort(edges.begin(), edges.end());
    for (const auto& [ratio, edge] : edges) {
        std::array<Index, 8> found;
        if (work.complex.edge_faces(edge[0], edge[1], found) > 0) split(work, edge[0], edge[1]);
    }
}

// Turns the edge of two faces of one surface if that widens their smallest angle.
bool try_flip(SurfaceComplex& complex, Index u, Index v) {
    constexpr double max_bend_cosine = 0.8, gain = 0.01;
    std::array<Index, 8> found;
    if (complex.edge_faces(u, v, found) != 2) return false;
    Face& one = complex.faces[found[0]];
    Face& two = complex.faces[found[1]];
    if (one.plane != two.plane) return false;
    const auto opposite = [&](const Face& face) {
        for (Index w : face.v)
            if (w != u && w != v) return w;
        return Index(-1);
    };
    const Index c = opposite(one), d = opposite(two);
    const auto& p = complex.points;
    // Largest cosine = smallest angle: (u, v, c), (u, v, d) against (u, d, c), (v, c, d).
    const double before =
        std::max(largest_cosine(p[u], p[v], p[c]), largest_cosine(p[u], p[v], p[d]));
    const double after =
        std::max(largest_cosine(p[u], p[d], p[c]), largest_cosine(p[v], p[c], p[d]));
    if (after > before - gain || c == d) return false;
    if (complex.edge_faces(c, d, found) > 0) return false;
    if (one.plane < 0 && (complex.planes[c] & complex.planes[d])) return false;
    complex.edge_faces(u, v, found);
    // new faces take the place of u in one and of v in the other, which keeps the orientation
    Face new_one = one, new_two = two;
    std::replace(new_one.v.begin(), new_one.v.end(), v, d);
    std::replace(new_two.v.begin(), new_two.v.end(), u, c);
    const Vec3 mean = (complex.area_vector(one) + complex.area_vector(two)).normalized();
    for (const Face* face : {&new_one, &new_two}) {
        const Vec3 area = complex.area_vector(*face);
        // Neither new face may leave the mean plane of the old two by more than 37 degrees.
        if (!(area.dot(mean) > max_bend_cosine * area.norm())) return false;
    }
    one = new_one, two = new_two;
    std::erase(complex.faces_of[v], found[0]);
    std::erase(complex.faces_of[u], found[1]);
    complex.faces_of[d].push_back(found[0]);
    complex.faces_of[c].push_back(found[1]);
    return true;
}

void flip_edges(SurfaceComplex& complex) {
    for (const auto& [u, v] : complex.edges()) try_flip(complex, u, v);
}

// Along the box only the box's own vertices count.
Vec3 middle_of_neighbours(const SurfaceComplex& complex, Index vertex) {
    std::vector<Index> around;
    find_neighbours(complex, vertex, around);
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (Index v : around) {
        if ((complex.planes[v] & complex.planes[vertex]) != complex.planes[vertex]) continue;
        sum += complex.points[v];
        ++count;
    }
    return count > 0 ? keep_on_planes(complex, vertex, sum / count) : complex.points[vertex];
}

RemeshWork work_on(SurfaceComplex& complex, const EdgeLengthAt& edge_length) {
    RemeshWork work{complex, std::vector<double>(complex.points.size())};
    for (Index v = 0; v < Index(complex.points.size()); ++v)
        work.wanted[v] = edge_length(complex, v);
    return work;
}

}  // namespace

void relax_staircase(SurfaceComplex& complex, const Interfaces& interfaces, const Vec3& reach_mm,
                     int rounds) {
    const std::vector<Vec3> start = complex.points;
    const double max_step = reach_mm.maxCoeff();
    for (int round = 0; round < rounds; ++round)
        for (Index v = 0; v < Index(start.size()); ++v) {
            const LabelSet labels = complex.labels_at(v);
            if (labels.count < 2) continue;
            Vec3 to = keep_on_planes(complex, v, evened_out(complex, v, false));
            // A damped Newton step to d = 0, d half the difference of the two labels' distances.
            to += interfaces.step_to_interface(to, labels.view(), complex.fixed_axes(v), max_step);
            complex.points[v] = to.cwiseMax(start[v] - reach_mm).cwiseMin(start[v] + reach_mm);
        }
}

void even_out(SurfaceComplex& complex, Index vertex) {
    complex.points[vertex] = middle_of_neighbours(complex, vertex);
}

void settle(SurfaceComplex& complex, const Interfaces& interfaces, double spread) {
    constexpr double max_step_mm = 1.0;
    for (Index v = 0; v < Index(complex.points.size()); ++v) {
        if (complex.faces_of[v].empty()) continue;
        Vec3 to = complex.points[v];
        if (spread > 0)
            // Even out along the surface, then step back onto d = 0.
            to += spread * (keep_on_planes(complex, v, evened_out(complex, v, true)) - to);
        const LabelSet labels = complex.labels_at(v);
        to += interfaces.step_to_interface(to, labels.view(), complex.fixed_axes(v), max_step_mm);
        move_guarded(complex, v, to);
    }
}

void remesh(SurfaceComplex& complex, const Interfaces& interfaces, const EdgeLengthAt& edge_length,
            int rounds, const ProgressSink& progress) {
    for (int round = 0; round < rounds; ++round) {
        check_cancelled(progress);
        RemeshWork work = work_on(complex, edge_length);
        // Split above 4/3, collapse below 4/5, flip, move: as Botsch and Kobbelt 2004, on a complex
        // of several surfaces that meet in curves.
        if (round > 0) split_long_edges(work);
        collapse_short_edges(work, 4.0 / 5.0);
        flip_edges(complex);
        complex.compact();
        settle(complex, interfaces, 0.7);
        settle(complex, interfaces, 0.7);
    }
}

void polish(SurfaceComplex& complex, const Interfaces& interfaces,
            const EdgeLengthAt& edge_length) {
    RemeshWork work = work_on(complex, edge_length);
    collapse_short_edges(work, 0.5);
    flip_edges(complex);
    complex.compact();
    for (const auto& [u, v] : complex.edges()) {
        if (sharpest_wedge(complex, u, v) <= acceptable_wedge_cosine) continue;
        for (Index vertex : {u, v})
            if (complex.kind(vertex) != Kind::corner)
                move_guarded(complex, vertex, middle_of_neighbours(complex, vertex));
    }
    settle(complex, interfaces, 0.5);
}

}  // namespace palpate

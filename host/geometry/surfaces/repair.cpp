// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/repair.hpp"

#include "host/geometry/surfaces/intersections.hpp"
#include "host/geometry/surfaces/remesh.hpp"

namespace palpate {

std::vector<std::array<Index, 2>> crossing_faces(const SurfaceComplex& complex) {
    std::vector<Triangle> triangles;
    triangles.reserve(complex.faces.size());
    for (const auto& face : complex.faces) triangles.push_back(face.v);
    return find_intersections(complex.points, triangles);
}

bool untangle(SurfaceComplex& complex, int rounds) {
    for (int round = 0; round < rounds; ++round) {
        const auto pairs = crossing_faces(complex);
        if (pairs.empty()) return true;
        std::vector<bool> moves(complex.points.size(), false);
        for (const auto& pair : pairs)
            for (Index f : pair)
                for (Index v : complex.faces[f].v) moves[v] = true;
        for (int width = 0; width < round / 3; ++width) {
            const std::vector<bool> inner = moves;
            for (const auto& face : complex.faces)
                if (inner[face.v[0]] || inner[face.v[1]] || inner[face.v[2]])
                    for (Index v : face.v) moves[v] = true;
        }
        for (int pass = 0; pass < 2; ++pass)
            for (Index v = 0; v < Index(moves.size()); ++v)
                if (moves[v]) even_out(complex, v);
    }
    return crossing_faces(complex).empty();
}

}  // namespace palpate

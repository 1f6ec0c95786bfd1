// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/region_fill.hpp"

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

namespace {

/// The faces of a tet of positive volume, counter-clockwise seen from outside; face i lacks node i.
constexpr int face_nodes[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

struct Face {
    Triangle nodes;  ///< sorted
    bool even;       ///< whether sorting was an even permutation of the outward order
    Index tet;       ///< -1: a triangle of the surface
    Index number;    ///< face of the tet, or number of the triangle
};

Face sorted_face(Triangle nodes, Index tet, Index number) {
    bool even = true;
    const auto order = [&](int i, int j) {
        if (nodes[i] > nodes[j]) {
            std::swap(nodes[i], nodes[j]);
            even = !even;
        }
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    return {nodes, even, tet, number};
}

std::vector<Face> all_faces(const std::vector<Tet>& tets, const std::vector<Triangle>& triangles) {
    std::vector<Face> faces;
    faces.reserve(tets.size() * 4 + triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        faces.push_back(sorted_face(triangles[i], -1, static_cast<Index>(i)));
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int f = 0; f < 4; ++f) {
            const Triangle nodes{tets[t][face_nodes[f][0]], tets[t][face_nodes[f][1]],
                                 tets[t][face_nodes[f][2]]};
            faces.push_back(sorted_face(nodes, static_cast<Index>(t), f));
        }
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
        return a.nodes != b.nodes ? a.nodes < b.nodes : a.tet < b.tet;
    });
    return faces;
}

[[noreturn]] void fail(const std::string& why) { throw Error(ErrorCode::mesh_failed, why); }

}  // namespace

std::vector<Index> fill_regions(const std::vector<Tet>& tets,
                                const std::vector<Triangle>& triangles,
                                const std::vector<std::array<Index, 2>>& regions,
                                std::vector<Index>* component) {
    const std::vector<Face> faces = all_faces(tets, triangles);
    std::vector<Index> region(tets.size(), -1);
    std::vector<std::array<Index, 4>> neighbour(tets.size(), {-1, -1, -1, -1});
    for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
        while (j < faces.size() && faces[j].nodes == faces[i].nodes) ++j;
        const bool on_surface = faces[i].tet < 0;
        if (on_surface && (j == i + 1)) fail("the mesher lost a triangle of the surface");
        if (j - i > (on_surface ? 3U : 2U)) fail("the mesher returned overlapping tets");
        if (!on_surface && j == i + 2) {
            neighbour[faces[i].tet][faces[i].number] = faces[i + 1].tet;
            neighbour[faces[i + 1].tet][faces[i + 1].number] = faces[i].tet;
        }
        for (std::size_t k = i + 1; on_surface && k < j; ++k) {
            // same order as the outward face: the normal points away from the tet, which is behind
            const Index side = regions[faces[i].number][faces[k].even == faces[i].even ? 0 : 1];
            Index& known = region[faces[k].tet];
            if (known >= 0 && known != side) fail("the mesher connected two regions");
            known = side;
        }
    }

    std::vector<Index> part(tets.size(), -1), front;
    Index num_parts = 0;
    for (std::size_t seed = 0; seed < tets.size(); ++seed) {
        if (region[seed] < 0 || part[seed] >= 0) continue;
        part[seed] = num_parts;
        front.assign(1, static_cast<Index>(seed));
        while (!front.empty()) {
            const Index tet = front.back();
            front.pop_back();
            for (Index next : neighbour[tet]) {
                if (next < 0 || part[next] >= 0) continue;
                if (region[next] >= 0 && region[next] != region[tet])
                    fail("the mesher connected two regions");
                region[next] = region[tet];
                part[next] = num_parts;
                front.push_back(next);
            }
        }
        ++num_parts;
    }
    if (std::find(part.begin(), part.end(), -1) != part.end())
        fail("the mesher returned tets that no surface encloses");
    if (component) *component = std::move(part);
    return region;
}

void interfaces_between_regions(const Mesh& mesh, std::vector<Triangle>& triangles,
                                std::vector<std::array<Index, 2>>& regions) {
    const std::vector<Face> faces = all_faces(mesh.tets, {});
    triangles.clear();
    regions.clear();
    for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
        while (j < faces.size() && faces[j].nodes == faces[i].nodes) ++j;
        if (j - i > 2) fail("the mesher returned overlapping tets");
        const Face* behind = &faces[i];
        const Face* front = j - i == 2 ? &faces[i + 1] : nullptr;
        if (front && mesh.region[front->tet] > mesh.region[behind->tet]) std::swap(behind, front);
        const Index beyond = front ? mesh.region[front->tet] : 0;
        if (mesh.region[behind->tet] == beyond) continue;
        const int* local = face_nodes[behind->number];
        const Tet& tet = mesh.tets[behind->tet];
        triangles.push_back({tet[local[0]], tet[local[1]], tet[local[2]]});
        regions.push_back({mesh.region[behind->tet], beyond});
    }
}

}  // namespace palpate::mesh_tool

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// A plain triangle surface, mm LPS. Triangles are counter-clockwise seen from outside.
struct Surface {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
};

/// One conforming surface between all regions: neighbouring regions share their triangles. The
/// normal of a triangle points from `regions[0]` (behind) to `regions[1]` (in front). The outer
/// side of the domain is `outside_region`.
struct RegionSurface {
    std::vector<Vec3> vertices;  ///< mm LPS
    std::vector<Triangle> triangles;
    std::vector<std::array<Index, 2>> regions;  ///< [num_triangles]
    std::vector<std::uint8_t> on_image_border;  ///< [num_triangles] 1: lies on the image box

    Index num_triangles() const { return static_cast<Index>(triangles.size()); }
};

/// The closed surface of one region, oriented outward; with `include_border` false the triangles on
/// the image box (caps) are left out and the surface is open there.
/// `vertex_of`, if given, receives the number in `all.vertices` of each vertex.
Surface surface_of_region(const RegionSurface& all, Index region, bool include_border = true,
                          std::vector<Index>* vertex_of = nullptr);

/// Enclosed volume of a closed surface, mm^3 (divergence theorem).
double enclosed_volume(const Surface& surface);
double surface_area(const Surface& surface);
/// A third of the area of the triangles round each vertex, mm^2: [num vertices], sum
/// `surface_area`.
std::vector<double> vertex_areas(const Surface& surface);
/// Of every vertex, those at the other ends of its edges.
std::vector<std::set<Index>> vertex_neighbours(const Surface& surface);
/// Unit normals of the vertices, triangles weighted by their area; zero where they cancel.
std::vector<Vec3> vertex_normals(const Surface& surface);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "host/geometry/surfaces/surface_complex.hpp"

namespace palpate {

constexpr double degree = 3.14159265358979323846 / 180;
/// Of an angle in a triangle.
const double acceptable_cosine = std::cos(25 * degree);

/// A complex whose edges are to get the wanted lengths.
struct RemeshWork {
    SurfaceComplex& complex;
    std::vector<double> wanted;  ///< edge length per vertex

    double length(Index u, Index v) const { return (complex.points[u] - complex.points[v]).norm(); }
    double wanted_at(Index u, Index v) const { return (wanted[u] + wanted[v]) / 2; }
};

/// Whether a face keeps its side and stays (or becomes) well shaped when one corner moves.
bool keeps_shape(const SurfaceComplex& complex, const SurfaceComplex::Face& face, Index moved,
                 const Vec3& to, double min_turn_cosine, double max_cosine = acceptable_cosine);

/// The neighbours of a vertex, sorted, into `around`.
void find_neighbours(const SurfaceComplex& complex, Index vertex, std::vector<Index>& around);

/// Collapses edges below `shortest` times the wanted length, the shortest first, where topology
/// (link condition of Dey et al. 1999 on faces and on feature curves) and shape allow it.
void collapse_short_edges(RemeshWork& work, double shortest);

}  // namespace palpate

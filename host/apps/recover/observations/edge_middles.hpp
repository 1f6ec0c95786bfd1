// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

struct VertexWeight {
    Index vertex = 0;
    double weight = 0;
};

/// A smooth displacement u of a surface in the middles of its edges, from that of its vertices. The
/// mean of both ends leaves l^2/8 of the second derivative out (0.04 mm of a wall that is bent by
/// 5 mm along 15 mm, with edges of 4 mm); a cubic with the slopes of both ends does not:
///   u((x_p + x_q) / 2) = (u_p + u_q) / 2 + (s_p - s_q) / 8,
///   s_v = g_v . (x_q - x_p),   g_v the gradient along the surface that fits the neighbours of v,
///   g_v = (sum t_j t_j^T)^-1 sum t_j (u_j - u_v),   t_j the part of x_j - x_v along the surface
/// (least squares).
/// Where the surface is not smooth, as at the edge of a box, and at the rim of an open one, the
/// mean of both ends.
class EdgeMiddles {
public:
    /// `normals` [num vertices]: of length 1.
    EdgeMiddles(const Surface& surface, const std::vector<Vec3>& normals);

    /// Of sum 1, each vertex once.
    std::vector<VertexWeight> at(Index p, Index q) const;

private:
    /// g_v = sum of `along` (u_j - u_v); none where no gradient is known.
    struct Neighbour {
        Index vertex;
        Vec3 along;  ///< 1/mm
    };
    std::vector<std::vector<Neighbour>> gradient_;
    std::vector<Vec3> vertices_;
};

}  // namespace palpate

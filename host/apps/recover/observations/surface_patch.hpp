// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

/// Places on a surface that a vertex stands for: itself and the middles of its edges. Voxels are
/// off from place to place, so that their mean is known better than one of them.
struct SurfacePatch {
    std::vector<Vec3> offsets{Vec3::Zero()};  ///< from the vertex, mm; it comes first
    /// Positive, of sum 1; the weighted mean of the offsets has no part along the surface, so that
    /// what is linear along it has the vertex's value for its mean.
    std::vector<double> weights{1.0};
    std::vector<Index>
        ends;  ///< vertices at the other ends of the edges: of all places but the first

    /// How many places of the surface belong to one of its vertices, an edge's middle half to each
    /// end.
    double num_places() const { return 1 + 0.5 * static_cast<double>(offsets.size() - 1); }
};

/// Of every vertex, [num vertices]: the vertex alone where no positive weights are such, as on the
/// rim of an open surface. `normals` [num vertices]: of length 1, what is across the surface there.
std::vector<SurfacePatch> surface_patches(const Surface& surface, const std::vector<Vec3>& normals);

}  // namespace palpate

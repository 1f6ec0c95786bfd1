// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/imaging/label_image.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate {

/// For every voxel centre of `grid`, the tetrahedron that holds it, or -1. `nodes` may be the
/// deformed positions of the mesh nodes [num_nodes] (mm, LPS). A centre on a shared face belongs to
/// the tet with the lower number. Cost: about the number of voxels covered.
std::vector<Index> tet_of_voxels(const Mesh& mesh, const std::vector<Vec3>& nodes,
                                 const ImageGrid& grid);

/// The displacement of the mesh nodes (mm, LPS) on the voxel centres of `grid`: linear inside tets;
/// where there is no tet (hollow organs, outside the domain) continued smoothly by solving
/// Laplace's equation on the grid with the meshed voxels as boundary values (zero normal derivative
/// at the image border).
Image<Vec3> displacement_on_grid(const Mesh& mesh, const std::vector<Vec3>& displacement,
                                 const ImageGrid& grid);

/// Carries a label image by a displacement field given on its own grid (reference to target, mm):
/// out(y) = labels(x) where x + u(x) = y, found by fixed-point iteration; nearest neighbour.
/// `out_grid` is the grid of the answer (the reference grid or the target's).
LabelImage warp_labels(const LabelImage& labels, const Image<Vec3>& displacement,
                       const ImageGrid& out_grid);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "host/io/image.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate {

/// For every voxel centre of `grid`, the tetrahedron that holds it, or -1. `nodes` may be the
/// deformed positions of the mesh nodes [num_nodes] (mm, LPS). A centre on a shared face belongs to
/// the tet with the lower number. Cost: about the number of voxels covered.
std::vector<Index> tet_of_voxels(const Mesh& mesh, const std::vector<Vec3>& nodes,
                                 const ImageGrid& grid);

/// Vectors at the nodes, on the voxel centres of a grid.
struct FieldInMesh {
    Image<Vec3> field;                     ///< linear inside tets, zero where there is none
    std::vector<std::uint8_t> is_outside;  ///< [num_voxels] 1 where there is no tet
};

/// `nodes` may be the deformed positions [num_nodes] (mm, LPS), `values` [num_nodes] any vectors.
FieldInMesh interpolate_in_mesh(const Mesh& mesh, const std::vector<Vec3>& nodes,
                                const std::vector<Vec3>& values, const ImageGrid& grid);

/// The displacement of the mesh nodes (mm, LPS) on the voxel centres of `grid`: linear inside tets;
/// where there is no tet (hollow organs, outside the domain) continued smoothly by solving
/// Laplace's equation on the grid with the meshed voxels as boundary values (zero normal derivative
/// at the image border).
Image<Vec3> displacement_on_grid(const Mesh& mesh, const std::vector<Vec3>& displacement,
                                 const ImageGrid& grid);

}  // namespace palpate

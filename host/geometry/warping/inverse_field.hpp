// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/io/image.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate {

struct InverseField {
    Image<Vec3> field;
    /// Voxels, all outside the mesh, where no place was found that comes within 0.01 mm: the
    /// nearest one that was found stands there.
    std::size_t num_unsure = 0;
};

/// The inverse of a deformation of a meshed body, on `grid` of the target: v with
/// y + v(y) = x and transform(x + u(x)) = y (mm, LPS).
///   mesh, displacement  u at the nodes: linear in each tet, so that inside the moved mesh the
///                       inverse is exact at the voxel centres
///   field               u on the reference's grid; continues u where there is no tet, and is
///                       inverted there by iteration to 1e-3 mm
/// Between voxel centres v is to be interpolated linearly: what is lost there is second order in
/// the spacing, and first order where u has a kink (between tissues). Cost: about a second for
/// 200^3 voxels on two cores.
InverseField inverse_field(const Mesh& mesh, const std::vector<Vec3>& displacement,
                           const Image<Vec3>& field, const RigidTransform& transform,
                           const ImageGrid& grid);

/// The inverse of a field by itself: v with y + v(y) = x and x + u(x) = y, to 1e-3 mm.
InverseField inverse_field(const Image<Vec3>& field, const ImageGrid& grid);

}  // namespace palpate

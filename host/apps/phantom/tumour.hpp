// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/phantom/organ_shape.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate {

/// Where a tumour of the prostate begins to grow (mm, LPS): in the back of one side, where most do;
/// the seed picks the side.
Vec3 tumour_centre(const OrganShape& prostate, unsigned seed);

/// Gives the tets of `region` that lie nearest to `centre` (mm, by their centroids) the number
/// `new_region`, as many as fill `fraction` (0..1) of the region's volume.
/// Returns the fraction that they fill, which differs by less than one tet.
double mark_ball(Mesh& mesh, Index region, Index new_region, const Vec3& centre, double fraction);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/geometry/mesh_tool/mesh_job.hpp"

namespace palpate::mesh_tool {

/// Refuses what makes TetGen crash, hang or return nothing: an empty surface, coordinates that are
/// not finite, indices out of range, vertices given twice, triangles without area or given twice,
/// regions whose surface is open or inside out. Throws Error(mesh_failed) with the first reason
/// found. Triangles that cross each other are not looked for: the parent outlives the crash.
void check_surface(const SurfaceJob& job);

}  // namespace palpate::mesh_tool

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Takes the place of tetgen_mesher.cpp where TetGen was not found.
#include "host/geometry/mesh_tool/mesh_job.hpp"
#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

std::string tetgen_name() { return {}; }

MeshReply mesh_with_tetgen(const SurfaceJob&) {
    throw Error(ErrorCode::unsupported, "palpate-mesh was built without TetGen");
}

}  // namespace palpate::mesh_tool

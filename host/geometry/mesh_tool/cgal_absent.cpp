// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Takes the place of cgal_mesher.cpp where CGAL was not found.
#include "host/geometry/mesh_tool/mesh_job.hpp"
#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

std::string cgal_name() { return {}; }

MeshReply mesh_with_cgal(const VolumeJob&) {
    throw Error(ErrorCode::unsupported, "palpate-mesh was built without CGAL");
}

}  // namespace palpate::mesh_tool

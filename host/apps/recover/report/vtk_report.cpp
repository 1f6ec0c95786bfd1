// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/vtk_report.hpp"

#include <fmt/format.h>

#include "host/geometry/meshing/solid_mesh_file.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// The mesh with file labels in the place of region numbers: what ready meshes hold.
SolidMesh with_file_labels(const RecoveryResult& result) {
    SolidMesh mesh = result.mesh;
    for (Index& region : mesh.region) {
        const auto same = [&](const RegionResult& r) { return r.region == region; };
        const auto found = std::find_if(result.regions.begin(), result.regions.end(), same);
        if (found == result.regions.end())
            throw Error(ErrorCode::internal,
                        fmt::format("mesh.vtu: region {} of the mesh is not in the result; report "
                                    "this defect",
                                    region));
        region = found->label;
    }
    return mesh;
}

}  // namespace

void write_vtk_report(const RecoveryResult& result, const std::filesystem::path& path) {
    SolidMeshArrays arrays;
    arrays.cell_scalars["stiffness_kpa"] = result.element_stiffness_kpa;
    arrays.point_vectors["displacement"] = result.displacement;
    arrays.point_vectors["force"] = result.force;
    for (const Held held : result.held)
        arrays.point_scalars["held"].push_back(static_cast<double>(held));
    write_solid_mesh(path, with_file_labels(result), arrays);
}

}  // namespace palpate

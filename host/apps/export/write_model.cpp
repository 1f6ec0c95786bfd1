// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/export/write_model.hpp"

#include <fmt/format.h>

#include "host/geometry/meshing/mesh_files.hpp"
#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/io/preflight.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

void write_vtk(const RecoveredModel& model, const std::filesystem::path& path) {
    MeshArrays arrays;
    arrays.point_vectors["displacement"] = model.displacement;
    arrays.point_vectors["force"] = model.force;
    for (const Held held : model.held)
        arrays.point_scalars["held"].push_back(static_cast<double>(held));
    auto& stiffness = arrays.cell_scalars["stiffness_kpa"];
    auto& ratio = arrays.cell_scalars["poisson_ratio"];
    stiffness.resize(model.mesh.tets.size());
    ratio.resize(model.mesh.tets.size());
    for (const ModelRegion& region : model.regions) {
        for (const Index t : region.tets) {
            stiffness[t] = region.stiffness_kpa;
            ratio[t] = region.poisson_ratio;
        }
    }
    write_vtu(path, model.mesh, arrays);
}

}  // namespace

void write_model(const RecoveredModel& model, WallLoad load, const std::filesystem::path& path) {
    if (has_ending(path, ".vtu")) {
        return write_atomically(path, [&](const auto& file) { write_vtk(model, file); });
    }
    std::string text;
    if (has_ending(path, ".feb")) {
        text = febio_model(model, load);
    } else if (has_ending(path, ".inp")) {
        text = abaqus_deck(model, load);
    } else if (has_ending(path, ".msh")) {
        text = gmsh_mesh(model);
    } else {
        throw Error(ErrorCode::unsupported,
                    fmt::format("cannot write '{}': a model is .feb (FEBio), .inp (CalculiX, "
                                "Abaqus), .msh (Gmsh) or .vtu, a displacement field .nii.gz or .h5",
                                path.string()));
    }
    write_atomically(path, [&](const auto& file) { write_text_file(file, text); });
}

}  // namespace palpate

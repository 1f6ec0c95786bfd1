// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/simulation_folder.hpp"

#include <fmt/format.h>

#include "host/apps/simulate/simulation_page.hpp"
#include "host/apps/simulate/simulation_tree.hpp"
#include "host/geometry/meshing/solid_mesh_file.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/tree_json.hpp"

namespace palpate {
namespace {

constexpr const char* mark = "simulation.json";

std::vector<Vec3> rows_of(const Eigen::VectorXd& values) {
    std::vector<Vec3> rows;
    for (Eigen::Index n = 0; 3 * n < values.size(); ++n)
        rows.emplace_back(values.segment<3>(3 * n));
    return rows;
}

SolidMeshArrays arrays_of(const SimulationState& state) {
    SolidMeshArrays arrays;
    arrays.point_vectors["displacement"] = rows_of(state.displacement);
    arrays.point_vectors["reaction"] = rows_of(state.reaction);
    arrays.cell_tensors["cauchy_stress_kpa"] = state.cells.stress_kpa;
    arrays.cell_scalars["von_mises_kpa"] = state.cells.von_mises_kpa;
    arrays.cell_scalars["volume_ratio"] = state.cells.volume_ratio;
    arrays.cell_scalars["energy_density_kpa"] = state.cells.energy_density_kpa;
    return arrays;
}

/// The list of states that ParaView opens as one series.
std::string series_pvd(const SimulationResult& result) {
    std::string out =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
    for (std::size_t k = 0; k < result.states.size(); ++k)
        out += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n",
                           result.states[k].time_s, state_file_name(k));
    return out + "  </Collection>\n</VTKFile>\n";
}

}  // namespace

void check_simulation_folder(const std::filesystem::path& folder, bool overwrite) {
    check_output_folder(folder, mark, overwrite);
}

void write_simulation(const SimulationResult& result, const std::filesystem::path& folder,
                      bool overwrite) {
    check_simulation_folder(folder, overwrite);
    SolidMesh mesh = result.mesh();
    for (Index& region : mesh.region) region = result.prepared.labels[region];
    write_folder_atomically(folder, overwrite, [&](const std::filesystem::path& inside) {
        for (std::size_t k = 0; k < result.states.size(); ++k)
            write_solid_mesh(inside / state_file_name(k), mesh, arrays_of(result.states[k]));
        write_text_file(inside / "simulation.pvd", series_pvd(result));
        write_text_file(inside / "reactions.csv", reactions_csv(result));
        write_text_file(inside / mark, tree_json(simulation_tree(result)));
        write_text_file(inside / "report.html", simulation_page(result));
    });
}

}  // namespace palpate

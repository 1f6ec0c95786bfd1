// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/prepare_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "host/apps/simulate/grid_mesh.hpp"
#include "host/apps/simulate/selection.hpp"
#include "solver/base/error.hpp"
#include "solver/elements/tet10.hpp"
#include "solver/elements/tri6.hpp"
#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

/// A node in the middle of an edge has the value of both its ends, or 0 where they differ: it
/// belongs to a set if both do.
void extend_arrays(const SolidMesh& quadratic, SolidMeshFile& file) {
    const bool is_plane = quadratic.type == ElementType::tri6;
    const std::span<const std::array<int, 2>> edges =
        is_plane ? std::span<const std::array<int, 2>>(tri6_edges) : tet10_edges;
    for (auto& [name, values] : file.point_scalars) {
        values.resize(quadratic.nodes.size(), 0.0);
        for (Index e = 0; e < quadratic.num_elements(); ++e) {
            const auto nodes = quadratic.nodes_of(e);
            for (std::size_t k = 0; k < edges.size(); ++k) {
                const double first = values[nodes[edges[k][0]]], last = values[nodes[edges[k][1]]];
                values[nodes[quadratic.table().num_corners + k]] = first == last ? first : 0;
            }
        }
    }
}

void make_quadratic(SolidMeshFile& file) {
    file.mesh = with_edge_nodes(file.mesh);
    extend_arrays(file.mesh, file);
}

/// A mesh that is made from the settings.
void make_graded(const MeshSettings& settings, SolidMeshFile& file) {
    try {
        file.mesh = graded_mesh(*settings.graded, settings.formulation);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::invalid_argument) throw;
        settings.source.fail(error.what());
    }
    file.point_scalars[graded_surface_array] = graded_surface(*settings.graded, file.mesh);
}

}  // namespace

SolidMeshFile prepare_mesh(const MeshSettings& settings) {
    SolidMeshFile file;
    if (settings.graded)
        make_graded(settings, file);
    else if (settings.file.empty())
        file.mesh = grid_mesh(settings.grid, settings.formulation);
    else
        file = read_solid_mesh(settings.file, settings.formulation, settings.region_array);
    for (Vec3& place : file.mesh.nodes) place *= settings.mm_per_unit;
    file.mesh.thickness_mm = settings.thickness_mm;
    for (const PartSettings& part : settings.parts) {
        const auto is_part = selected_elements(part.where, file.mesh);
        for (std::size_t e = 0; e < is_part.size(); ++e)
            if (is_part[e]) file.mesh.region[e] = part.region;
    }
    try {
        if (settings.quadratic) make_quadratic(file);
        check_mesh(file.mesh);
        point_geometry(file.mesh);
    } catch (const Error& error) {
        settings.source.fail(error.what());
    }
    return file;
}

std::vector<Index> number_regions(const std::vector<MaterialSettings>& materials,
                                  const MeshSettings& settings, SolidMesh& mesh) {
    if (!materials.front().region) {
        std::fill(mesh.region.begin(), mesh.region.end(), 0);
        return {1};
    }
    std::map<Index, Index> number;
    std::vector<Index> labels;
    for (const MaterialSettings& material : materials) {
        number[*material.region] = static_cast<Index>(labels.size());
        labels.push_back(*material.region);
    }
    for (const MaterialSettings& material : materials)
        if (std::count(mesh.region.begin(), mesh.region.end(), *material.region) == 0)
            material.source.refuse("region",
                                   "no element of the mesh has this label; mend it, or "
                                   "remove the material");
    for (Index& region : mesh.region) {
        const auto found = number.find(region);
        if (found == number.end())
            settings.source.fail(fmt::format(
                "elements with label {0} have no [[material]]; add one with region = {0}", region));
        region = found->second;
    }
    return labels;
}

}  // namespace palpate

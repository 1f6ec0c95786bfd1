// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>

#include "host/geometry/meshing/mesh_file_errors.hpp"
#include "host/geometry/meshing/mesh_files.hpp"
#include "host/geometry/meshing/vtk_grid.hpp"
#include "solver/base/error.hpp"

namespace palpate {

namespace {

namespace fs = std::filesystem;

/// What was kept of a file: numbers of its points and cells.
struct Kept {
    std::vector<vtkIdType> points, cells;
};

void take_tets(const fs::path& path, vtkUnstructuredGrid& grid, Mesh& mesh, Kept& kept) {
    const vtkIdType num_points = grid.GetNumberOfPoints();
    std::vector<Index> number(static_cast<std::size_t>(num_points), -1);
    vtkIdType size = 0;
    const vtkIdType* nodes = nullptr;
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
        const int type = grid.GetCellType(c);
        if (type != VTK_TETRA) {
            if (type == VTK_VERTEX || type == VTK_LINE || type == VTK_TRIANGLE) continue;
            unusable_mesh(path, "it holds cells of VTK type " + std::to_string(type) +
                                    "; only linear tetrahedra are taken");
        }
        grid.GetCellPoints(c, size, nodes);
        if (size != 4) unreadable_mesh(path, "a tetrahedron does not have 4 nodes");
        Tet tet{};
        for (int k = 0; k < 4; ++k) {
            if (nodes[k] < 0 || nodes[k] >= num_points)
                unreadable_mesh(path, "a node is out of range");
            Index& n = number[static_cast<std::size_t>(nodes[k])];
            if (n < 0) n = 0;
            tet[k] = static_cast<Index>(nodes[k]);
        }
        mesh.tets.push_back(tet);
        kept.cells.push_back(c);
    }
    if (mesh.tets.empty()) unusable_mesh(path, "it holds no tetrahedra");
    for (vtkIdType p = 0; p < num_points; ++p) {
        if (number[static_cast<std::size_t>(p)] < 0) continue;
        number[static_cast<std::size_t>(p)] = static_cast<Index>(kept.points.size());
        kept.points.push_back(p);
        Vec3 point;
        grid.GetPoint(p, point.data());
        if (!point.allFinite()) unreadable_mesh(path, "a node is not finite");
        mesh.nodes.push_back(point);
    }
    for (Tet& tet : mesh.tets)
        for (Index& node : tet) node = number[node];
}

void turn_inverted(const fs::path& path, Mesh& mesh) {
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        const double volume = tet_volume(mesh, t);
        if (volume < 0) std::swap(mesh.tets[t][2], mesh.tets[t][3]);
        if (!(volume != 0)) unusable_mesh(path, "tetrahedron " + std::to_string(t) + " is flat");
    }
}

void take_regions(const fs::path& path, vtkUnstructuredGrid& grid, const std::string& name,
                  Mesh& mesh, const Kept& kept) {
    vtkDataArray* array = grid.GetCellData()->GetArray(name.c_str());
    if (!array)
        unusable_mesh(path,
                      "it has no cell array '" + name + "' that holds the label of each cell");
    if (array->GetNumberOfComponents() != 1 || array->GetNumberOfTuples() < grid.GetNumberOfCells())
        unusable_mesh(path, "its cell array '" + name + "' does not hold one number per cell");
    for (vtkIdType cell : kept.cells) {
        const double value = array->GetComponent(cell, 0);
        if (!(value >= 0 && value <= 65535) || value != std::floor(value))
            unusable_mesh(path,
                          "its cell array '" + name + "' must hold whole numbers from 0 to 65535");
        mesh.region.push_back(static_cast<Index>(value));
    }
}

/// Copies the arrays with 1 (and for points 3) components, kept rows only.
void take_arrays(vtkUnstructuredGrid& grid, const Kept& kept, const std::string& region_name,
                 MeshArrays& arrays) {
    vtkPointData* point_data = grid.GetPointData();
    for (int i = 0; i < point_data->GetNumberOfArrays(); ++i) {
        vtkDataArray* array = point_data->GetArray(i);
        if (!array || !array->GetName()) continue;
        if (array->GetNumberOfTuples() < grid.GetNumberOfPoints()) continue;
        for (vtkIdType p : kept.points) {
            if (array->GetNumberOfComponents() == 1)
                arrays.point_scalars[array->GetName()].push_back(array->GetComponent(p, 0));
            if (array->GetNumberOfComponents() == 3)
                arrays.point_vectors[array->GetName()].emplace_back(array->GetComponent(p, 0),
                                                                    array->GetComponent(p, 1),
                                                                    array->GetComponent(p, 2));
        }
    }
    vtkCellData* cell_data = grid.GetCellData();
    for (int i = 0; i < cell_data->GetNumberOfArrays(); ++i) {
        vtkDataArray* array = cell_data->GetArray(i);
        if (!array || !array->GetName() || array->GetName() == region_name) continue;
        if (array->GetNumberOfComponents() != 1 ||
            array->GetNumberOfTuples() < grid.GetNumberOfCells())
            continue;
        for (vtkIdType c : kept.cells)
            arrays.cell_scalars[array->GetName()].push_back(array->GetComponent(c, 0));
    }
}

}  // namespace

Mesh read_vtu(const fs::path& path, const std::string& region_name, MeshArrays* arrays) {
    const auto grid = read_vtk_grid(path);
    Mesh mesh;
    Kept kept;
    take_tets(path, *grid, mesh, kept);
    take_regions(path, *grid, region_name, mesh, kept);
    turn_inverted(path, mesh);
    if (arrays) take_arrays(*grid, kept, region_name, *arrays);
    return mesh;
}

}  // namespace palpate

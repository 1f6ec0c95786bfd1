// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include "host/geometry/meshing/mesh_files.hpp"
#include "host/geometry/meshing/vtk_grid.hpp"
#include "solver/base/error.hpp"

namespace palpate {

namespace {

void require_size(std::size_t size, std::size_t wanted, const std::string& name) {
    if (size != wanted)
        throw Error(ErrorCode::invalid_argument, "mesh array '" + name + "' has " +
                                                     std::to_string(size) + " values for " +
                                                     std::to_string(wanted) + " nodes or tets");
}

vtkSmartPointer<vtkUnstructuredGrid> make_grid(const Mesh& mesh, const MeshArrays& arrays,
                                               const std::string& region_name) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetData(vtk_array("Points", mesh.nodes));
    grid->SetPoints(points);
    grid->Allocate(mesh.num_tets());
    for (const Tet& tet : mesh.tets) {
        const vtkIdType nodes[4] = {tet[0], tet[1], tet[2], tet[3]};
        grid->InsertNextCell(VTK_TETRA, 4, nodes);
    }
    require_size(mesh.region.size(), mesh.tets.size(), region_name);
    vtkNew<vtkIntArray> region;
    region->SetName(region_name.c_str());
    for (Index value : mesh.region) region->InsertNextValue(value);
    grid->GetCellData()->AddArray(region);
    for (const auto& [name, values] : arrays.point_scalars) {
        require_size(values.size(), mesh.nodes.size(), name);
        grid->GetPointData()->AddArray(vtk_array(name, values));
    }
    for (const auto& [name, values] : arrays.point_vectors) {
        require_size(values.size(), mesh.nodes.size(), name);
        grid->GetPointData()->AddArray(vtk_array(name, values));
    }
    for (const auto& [name, values] : arrays.cell_scalars) {
        require_size(values.size(), mesh.tets.size(), name);
        grid->GetCellData()->AddArray(vtk_array(name, values));
    }
    return grid;
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const Mesh& mesh, const MeshArrays& arrays,
               const std::string& region_name) {
    write_vtk_grid(path, *make_grid(mesh, arrays, region_name));
}

}  // namespace palpate

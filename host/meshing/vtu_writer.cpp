// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>

#include "host/meshing/io.hpp"
#include "host/surfaces/vtk_messages.hpp"
#include "solver/base/error.hpp"

namespace palpate {

namespace {

vtkSmartPointer<vtkDoubleArray> to_vtk(const std::string& name, const std::vector<double>& values) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    return array;
}

vtkSmartPointer<vtkDoubleArray> to_vtk(const std::string& name, const std::vector<Vec3>& values) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i)
        array->SetTypedTuple(static_cast<vtkIdType>(i), values[i].data());
    return array;
}

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
    points->SetData(to_vtk("Points", mesh.nodes));
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
        grid->GetPointData()->AddArray(to_vtk(name, values));
    }
    for (const auto& [name, values] : arrays.point_vectors) {
        require_size(values.size(), mesh.nodes.size(), name);
        grid->GetPointData()->AddArray(to_vtk(name, values));
    }
    for (const auto& [name, values] : arrays.cell_scalars) {
        require_size(values.size(), mesh.tets.size(), name);
        grid->GetCellData()->AddArray(to_vtk(name, values));
    }
    vtkNew<vtkStringArray> space;
    space->SetName("SPACE");
    space->InsertNextValue("LPS");
    grid->GetFieldData()->AddArray(space);
    return grid;
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const Mesh& mesh, const MeshArrays& arrays,
               const std::string& region_name) {
    const auto grid = make_grid(mesh, arrays, region_name);
    VtkMessages messages;
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(grid);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToZLib();
    if (writer->Write() != 1 || messages.any())
        throw Error(ErrorCode::output_failed,
                    "cannot write the mesh '" + path.string() + "': " + messages.last());
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/solid_mesh_file.hpp"

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>

#include "host/geometry/meshing/mesh_file_errors.hpp"
#include "host/geometry/meshing/vtk_grid.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// One kind of cell that is an element. VTK numbers the nodes as `ElementTable` does.
struct CellKind {
    int vtk_type;
    ElementType type;
    std::vector<int> reversed;  ///< its nodes in an order that turns the element round
};

const std::vector<CellKind>& cell_kinds() {
    static const std::vector<CellKind> kinds{
        {VTK_TETRA, ElementType::tet4, {0, 1, 3, 2}},
        {VTK_QUADRATIC_TETRA, ElementType::tet10, {0, 1, 3, 2, 4, 8, 7, 6, 5, 9}},
        {VTK_TRIANGLE, ElementType::tri3, {0, 2, 1}},
        {VTK_QUADRATIC_TRIANGLE, ElementType::tri6, {0, 2, 1, 5, 4, 3}},
        {VTK_QUAD, ElementType::quad4, {0, 3, 2, 1}}};
    return kinds;
}

const CellKind* kind_of_cell(int vtk_type) {
    for (const CellKind& kind : cell_kinds())
        if (kind.vtk_type == vtk_type) return &kind;
    return nullptr;
}

const CellKind& kind_of(ElementType type) {
    return *std::find_if(cell_kinds().begin(), cell_kinds().end(),
                         [&](const CellKind& kind) { return kind.type == type; });
}

bool is_lower_cell(int vtk_type, int dimension) {
    if (const CellKind* kind = kind_of_cell(vtk_type))
        return element_table(kind->type).dimension < dimension;
    return vtk_type == VTK_VERTEX || vtk_type == VTK_POLY_VERTEX || vtk_type == VTK_LINE ||
           vtk_type == VTK_POLY_LINE || vtk_type == VTK_QUADRATIC_EDGE;
}

/// Cells that are elements of this dimension; all of one kind.
std::vector<vtkIdType> element_cells(const fs::path& path, vtkUnstructuredGrid& grid, int dimension,
                                     ElementType& type) {
    const std::string wanted = dimension == 3 ? "linear or quadratic tetrahedra"
                                              : "triangles, quadratic triangles or quadrilaterals";
    std::vector<vtkIdType> cells;
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
        const int vtk_type = grid.GetCellType(c);
        if (is_lower_cell(vtk_type, dimension)) continue;
        const CellKind* kind = kind_of_cell(vtk_type);
        if (!kind || element_table(kind->type).dimension != dimension)
            unusable_mesh(path, "it holds cells of VTK type " + std::to_string(vtk_type) +
                                    "; this formulation takes " + wanted);
        if (!cells.empty() && kind->type != type)
            unusable_mesh(path, "it mixes " + element_table(type).name + " and " +
                                    element_table(kind->type).name + "; give elements of one kind");
        type = kind->type;
        cells.push_back(c);
    }
    if (cells.empty()) unusable_mesh(path, "it holds no " + wanted);
    return cells;
}

/// Takes elements and the points they use; returns these points' numbers in the file.
std::vector<vtkIdType> take_elements(const fs::path& path, vtkUnstructuredGrid& grid,
                                     const std::vector<vtkIdType>& cells, SolidMesh& mesh) {
    const vtkIdType num_points = grid.GetNumberOfPoints();
    std::vector<Index> number(static_cast<std::size_t>(num_points), -1);
    std::vector<vtkIdType> kept;
    for (const vtkIdType c : cells) {
        vtkIdType size = 0;
        const vtkIdType* nodes = nullptr;
        grid.GetCellPoints(c, size, nodes);
        if (size != mesh.table().num_nodes) unreadable_mesh(path, "an element lacks nodes");
        for (vtkIdType k = 0; k < size; ++k) {
            if (nodes[k] < 0 || nodes[k] >= num_points)
                unreadable_mesh(path, "a node is out of range");
            Index& node = number[static_cast<std::size_t>(nodes[k])];
            if (node < 0) {
                node = mesh.num_nodes();
                kept.push_back(nodes[k]);
                mesh.nodes.emplace_back();
                grid.GetPoint(nodes[k], mesh.nodes.back().data());
                if (!mesh.nodes.back().allFinite()) unreadable_mesh(path, "a node is not finite");
            }
            mesh.elements.push_back(node);
        }
    }
    return kept;
}

/// Twice the area or six times the volume of the corners, with its sign.
double signed_size(const SolidMesh& mesh, std::span<const Index> nodes) {
    const auto from_first = [&](int k) -> Vec3 {
        return mesh.nodes[nodes[k]] - mesh.nodes[nodes[0]];
    };
    if (mesh.table().dimension == 3) return from_first(1).dot(from_first(2).cross(from_first(3)));
    if (mesh.type != ElementType::quad4) return from_first(1).cross(from_first(2)).z();
    const Vec3 across = mesh.nodes[nodes[3]] - mesh.nodes[nodes[1]];
    return from_first(2).cross(across).z();
}

void turn_inverted(SolidMesh& mesh) {
    const std::vector<int>& reversed = kind_of(mesh.type).reversed;
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        if (!(signed_size(mesh, mesh.nodes_of(e)) < 0)) continue;
        Index* nodes = mesh.elements.data() + reversed.size() * static_cast<std::size_t>(e);
        const std::vector<Index> before(nodes, nodes + reversed.size());
        for (std::size_t a = 0; a < reversed.size(); ++a) nodes[a] = before[reversed[a]];
    }
}

void take_labels(const fs::path& path, vtkUnstructuredGrid& grid,
                 const std::optional<std::string>& asked, const std::vector<vtkIdType>& cells,
                 SolidMesh& mesh) {
    const std::string name = asked.value_or("region");
    if (!asked && !grid.GetCellData()->HasArray(name.c_str())) {
        mesh.region.assign(cells.size(), 1);
        return;
    }
    vtkDataArray* array = grid.GetCellData()->GetArray(name.c_str());
    if (!array || array->GetNumberOfComponents() != 1 ||
        array->GetNumberOfTuples() < grid.GetNumberOfCells())
        unusable_mesh(path, "it has no cell array '" + name + "' with one label per cell");
    for (const vtkIdType cell : cells) {
        const double value = array->GetComponent(cell, 0);
        if (!(value >= 0 && value <= 65535) || value != std::floor(value))
            unusable_mesh(path,
                          "its cell array '" + name + "' must hold whole numbers from 0 to 65535");
        mesh.region.push_back(static_cast<Index>(value));
    }
}

void take_point_scalars(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& points,
                        SolidMeshFile& file) {
    vtkPointData* data = grid.GetPointData();
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
        vtkDataArray* array = data->GetArray(i);
        if (!array || !array->GetName() || array->GetNumberOfComponents() != 1 ||
            array->GetNumberOfTuples() < grid.GetNumberOfPoints())
            continue;
        for (const vtkIdType p : points)
            file.point_scalars[array->GetName()].push_back(array->GetComponent(p, 0));
    }
}

vtkSmartPointer<vtkDoubleArray> tensor_array(const std::string& name,
                                             const std::vector<std::array<double, 6>>& values) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(6);
    const char* components[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    for (int k = 0; k < 6; ++k) array->SetComponentName(k, components[k]);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i)
        array->SetTypedTuple(static_cast<vtkIdType>(i), values[i].data());
    return array;
}

}  // namespace

SolidMeshFile read_solid_mesh(const fs::path& path, Formulation formulation,
                              const std::optional<std::string>& region_name) {
    const auto grid = read_vtk_grid(path);
    SolidMeshFile file;
    SolidMesh& mesh = file.mesh;
    mesh.formulation = formulation;
    const int dimension = formulation == Formulation::solid ? 3 : 2;
    const auto cells = element_cells(path, *grid, dimension, mesh.type);
    const auto points = take_elements(path, *grid, cells, mesh);
    take_labels(path, *grid, region_name, cells, mesh);
    turn_inverted(mesh);
    take_point_scalars(*grid, points, file);
    return file;
}

void write_solid_mesh(const fs::path& path, const SolidMesh& mesh, const SolidMeshArrays& arrays) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetData(vtk_array("Points", mesh.nodes));
    grid->SetPoints(points);
    grid->Allocate(mesh.num_elements());
    vtkNew<vtkIntArray> region;
    region->SetName("region");
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        const auto nodes = mesh.nodes_of(e);
        const std::vector<vtkIdType> ids(nodes.begin(), nodes.end());
        grid->InsertNextCell(kind_of(mesh.type).vtk_type, static_cast<vtkIdType>(ids.size()),
                             ids.data());
        region->InsertNextValue(mesh.region[e]);
    }
    grid->GetCellData()->AddArray(region);
    for (const auto& [name, values] : arrays.point_scalars)
        grid->GetPointData()->AddArray(vtk_array(name, values));
    for (const auto& [name, values] : arrays.point_vectors)
        grid->GetPointData()->AddArray(vtk_array(name, values));
    for (const auto& [name, values] : arrays.cell_scalars)
        grid->GetCellData()->AddArray(vtk_array(name, values));
    for (const auto& [name, values] : arrays.cell_tensors)
        grid->GetCellData()->AddArray(tensor_array(name, values));
    write_vtk_grid(path, *grid);
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/vtk_grid.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <type_traits>

#include "host/geometry/meshing/mesh_file_errors.hpp"
#include "host/geometry/surfaces/vtk_cells.hpp"
#include "host/geometry/surfaces/vtk_copy.hpp"
#include "host/geometry/surfaces/vtk_messages.hpp"
#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

template <typename Reader>
vtkSmartPointer<vtkUnstructuredGrid> run_reader(const fs::path& path) {
    VtkMessages messages;
    vtkNew<Reader> reader;
    reader->SetFileName(path.c_str());
    if constexpr (std::is_same_v<Reader, vtkUnstructuredGridReader>) {
        reader->ReadAllScalarsOn();
        reader->ReadAllVectorsOn();
        reader->ReadAllFieldsOn();
    }
    try {
        reader->Update();
    } catch (const std::exception& error) {  // sizes in damaged files
        unreadable_mesh(path, error.what());
    }
    vtkSmartPointer<vtkUnstructuredGrid> grid = reader->GetOutput();
    if (messages.any()) unreadable_mesh(path, "it is damaged: " + messages.last());
    if (!grid || grid->GetNumberOfPoints() == 0 || !grid->GetPoints())
        unreadable_mesh(path, "it holds no points");
    if (!grid->GetCells()) grid->SetCells(VTK_TETRA, vtkNew<vtkCellArray>());  // points only
    if (const auto why = why_unsafe(*grid->GetCells(), grid->GetNumberOfPoints()))
        unreadable_mesh(path, *why);
    return grid;
}

template <typename Reader>
vtkSmartPointer<vtkUnstructuredGrid> read_with(const fs::path& path) {
    return read_by_copy<vtkXMLUnstructuredGridWriter>(path, run_reader<Reader>,
                                                      run_reader<vtkXMLUnstructuredGridReader>);
}

/// VTK's reader of the legacy format leaves types that are missing as they were in memory. From
/// version 5 of the format on, offsets are counted in place of cells: one more.
void check_numbers_of_types(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    long long num_cells = -1, num_types = -1;
    for (std::string line; std::getline(file, line);) {
        std::sscanf(line.c_str(), "CELLS %lld", &num_cells);
        std::sscanf(line.c_str(), "CELL_TYPES %lld", &num_types);
        if (line.starts_with("OFFSETS ")) --num_cells;
    }
    if (num_cells >= 0 && num_types >= 0 && num_cells != num_types)
        unreadable_mesh(path,
                        fmt::format("it has {} cells but {} types of cells", num_cells, num_types));
}

}  // namespace

vtkSmartPointer<vtkUnstructuredGrid> read_vtk_grid(const fs::path& path) {
    if (const auto why = why_unreadable(path)) unreadable_mesh(path, *why);
    const std::string extension = path.extension().string();
    if (extension == ".vtu") return read_with<vtkXMLUnstructuredGridReader>(path);
    if (extension == ".vtk") {
        check_numbers_of_types(path);
        return read_with<vtkUnstructuredGridReader>(path);
    }
    unreadable_mesh(path, "its name must end in .vtu or .vtk");
}

void write_vtk_grid(const fs::path& path, vtkUnstructuredGrid& grid) {
    vtkNew<vtkStringArray> space;
    space->SetName("SPACE");
    space->InsertNextValue("LPS");
    grid.GetFieldData()->AddArray(space);
    VtkMessages messages;
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(&grid);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToZLib();
    if (writer->Write() != 1 || messages.any() || writer->GetErrorCode() != 0)
        throw Error(ErrorCode::output_failed,
                    "cannot write the mesh '" + path.filename().string() +
                        "': " + vtkErrorCode::GetStringFromErrorCode(writer->GetErrorCode()) +
                        "; check free space and permissions");
}

vtkSmartPointer<vtkDoubleArray> vtk_array(const std::string& name,
                                          const std::vector<double>& values) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    return array;
}

vtkSmartPointer<vtkDoubleArray> vtk_array(const std::string& name,
                                          const std::vector<Vec3>& values) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i)
        array->SetTypedTuple(static_cast<vtkIdType>(i), values[i].data());
    return array;
}

}  // namespace palpate

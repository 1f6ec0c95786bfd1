// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkDoubleArray.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <filesystem>
#include <string>
#include <vector>

#include "solver/base/types.hpp"

// Unstructured grids in files, before anybody asks what their cells are.
namespace palpate {

/// Reads .vtu or legacy .vtk with all its arrays. Throws Error(input_unreadable): missing, damaged,
/// another ending, no points.
vtkSmartPointer<vtkUnstructuredGrid> read_vtk_grid(const std::filesystem::path& path);

/// Writes .vtu (appended, compressed), with field data SPACE = LPS. Throws Error(output_failed).
void write_vtk_grid(const std::filesystem::path& path, vtkUnstructuredGrid& grid);

vtkSmartPointer<vtkDoubleArray> vtk_array(const std::string& name,
                                          const std::vector<double>& values);
vtkSmartPointer<vtkDoubleArray> vtk_array(const std::string& name, const std::vector<Vec3>& values);

}  // namespace palpate

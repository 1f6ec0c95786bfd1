// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/moved_grid.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cmath>

#include "host/geometry/meshing/vtk_grid.hpp"
#include "host/geometry/surfaces/vtk_messages.hpp"
#include "host/io/files.hpp"
#include "host/io/preflight.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Voxels that lines pass through along one axis: the first, the last and those between.
std::vector<Index> places(Index size, double spacing, double every_mm) {
    const auto step = std::max<Index>(1, static_cast<Index>(std::lround(every_mm / spacing)));
    std::vector<Index> list;
    for (Index i = 0; i < size; i += step) list.push_back(i);
    if (list.back() != size - 1) list.push_back(size - 1);
    return list;
}

void add_line(const PointMap& map, const ImageGrid& grid, int axis, Vec3 index, MovedGrid& out) {
    std::vector<Index> line;
    for (Index i = 0; i < grid.size[axis]; ++i) {
        index[axis] = i;
        const Vec3 x = grid.to_point(index);
        const MovedPoint moved = map.moved(x);
        line.push_back(static_cast<Index>(out.points.size()));
        out.points.push_back(moved);
        out.displacement.push_back(moved.point - x);
    }
    out.lines.push_back(std::move(line));
}

vtkSmartPointer<vtkPolyData> poly_data(const MovedGrid& grid) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkUnsignedCharArray> inside;
    inside->SetName("inside");
    for (const MovedPoint& p : grid.points) {
        points->InsertNextPoint(p.point.data());
        inside->InsertNextValue(p.inside && p.found ? 1 : 0);
    }
    vtkNew<vtkCellArray> lines;
    for (const auto& line : grid.lines) {
        lines->InsertNextCell(static_cast<int>(line.size()));
        for (const Index point : line) lines->InsertCellPoint(point);
    }
    vtkNew<vtkStringArray> space;
    space->SetName("SPACE");
    space->InsertNextValue("LPS");
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetLines(lines);
    data->GetPointData()->AddArray(vtk_array("displacement", grid.displacement));
    data->GetPointData()->AddArray(inside);
    data->GetFieldData()->AddArray(space);
    return data;
}

}  // namespace

MovedGrid moved_grid(const PointMap& map, const ImageGrid& grid, double every_mm) {
    if (!(every_mm > 0)) {
        throw Error(
            ErrorCode::invalid_argument,
            fmt::format("the distance of grid lines must be positive, not {} mm", every_mm));
    }
    MovedGrid out;
    for (int axis = 0; axis < 3; ++axis) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (const Index j : places(grid.size[b], grid.spacing[b], every_mm)) {
            for (const Index k : places(grid.size[c], grid.spacing[c], every_mm)) {
                Vec3 index = Vec3::Zero();
                index[b] = j;
                index[c] = k;
                add_line(map, grid, axis, index, out);
            }
        }
    }
    return out;
}

void write_moved_grid(const std::filesystem::path& path, const MovedGrid& grid) {
    if (!has_ending(path, ".vtp")) {
        throw Error(ErrorCode::unsupported,
                    fmt::format("cannot write '{}': a grid of lines is .vtp", path.string()));
    }
    const auto data = poly_data(grid);
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        VtkMessages messages;
        vtkNew<vtkXMLPolyDataWriter> writer;
        writer->SetFileName(temporary.c_str());
        writer->SetInputData(data);
        writer->SetDataModeToAppended();
        writer->EncodeAppendedDataOff();
        writer->SetCompressorTypeToZLib();
        if (writer->Write() != 1 || messages.any())
            throw Error(ErrorCode::output_failed, messages.last());
    });
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/read_shapes.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCleanPolyData.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <string>

#include "host/geometry/surfaces/point_text.hpp"
#include "host/geometry/surfaces/vtk_cells.hpp"
#include "host/geometry/surfaces/vtk_copy.hpp"
#include "host/geometry/surfaces/vtk_messages.hpp"
#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using PolyData = vtkSmartPointer<vtkPolyData>;

constexpr std::size_t least_read_points = 8;

[[noreturn]] void unreadable(const fs::path& path, const std::string& why) {
    throw Error(ErrorCode::input_unreadable,
                fmt::format("cannot read the target '{}': {}", path.string(), why));
}
[[noreturn]] void unusable(const fs::path& path, const std::string& why) {
    throw Error(ErrorCode::input_unusable,
                fmt::format("the target '{}' cannot be used: {}", path.string(), why));
}

std::string ending_of(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return ending;
}

std::vector<Vec3> read_text(const fs::path& path) {
    std::ifstream file(path);
    try {
        return points_of_text(file);
    } catch (const Error& error) {
        unreadable(path, error.what());
    }
}

template <typename Reader>
PolyData run_reader(const fs::path& path) {
    VtkMessages messages;
    vtkNew<Reader> reader;
    reader->SetFileName(path.c_str());
    try {
        reader->Update();
    } catch (const std::exception& error) {  // sizes in damaged files
        unreadable(path, error.what());
    }
    if (messages.any()) unreadable(path, "it is damaged: " + messages.last());
    PolyData data = reader->GetOutput();
    if (!data || !data->GetPoints() || data->GetNumberOfPoints() == 0) {
        unreadable(path, "it holds no points");
    }
    for (vtkCellArray* cells :
         {data->GetVerts(), data->GetLines(), data->GetPolys(), data->GetStrips()})
        if (const auto why = why_unsafe(*cells, data->GetNumberOfPoints())) unreadable(path, *why);
    return data;
}

template <typename Reader>
PolyData read_with(const fs::path& path) {
    return read_by_copy<vtkXMLPolyDataWriter>(path, run_reader<Reader>,
                                              run_reader<vtkXMLPolyDataReader>);
}

/// Null for an ending that is not polydata.
PolyData read_polydata(const fs::path& path, const std::string& ending) {
    if (ending == ".vtp") return read_with<vtkXMLPolyDataReader>(path);
    if (ending == ".vtk") return read_with<vtkPolyDataReader>(path);
    if (ending == ".ply") return read_with<vtkPLYReader>(path);
    return nullptr;
}

std::vector<Vec3> points_of(vtkPolyData& data) {
    std::vector<Vec3> points(data.GetNumberOfPoints());
    for (std::size_t k = 0; k < points.size(); ++k) {
        data.GetPoint(static_cast<vtkIdType>(k), points[k].data());
    }
    return points;
}

void check_finite(const std::vector<Vec3>& points, const fs::path& path) {
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (points[k].allFinite()) continue;
        unusable(path, fmt::format("its point {} has a coordinate that is not a finite number; "
                                   "leave such points out",
                                   k + 1));
    }
}

void turn_to_lps(std::vector<Vec3>& points, Frame frame) {
    if (frame == Frame::lps) return;
    for (Vec3& point : points) point.head<2>() *= -1;
}

PolyData cleaned_triangles(vtkPolyData& data) {
    VtkMessages silence;
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(&data);
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    vtkNew<vtkCleanPolyData> merged;
    merged->SetInputConnection(triangles->GetOutputPort());
    merged->SetTolerance(0);
    merged->Update();
    return merged->GetOutput();
}

/// Triangles that have an area.
std::vector<Triangle> triangles_of(vtkPolyData& data, const std::vector<Vec3>& points) {
    std::vector<Triangle> triangles;
    vtkIdType size = 0;
    const vtkIdType* corners = nullptr;
    for (data.GetPolys()->InitTraversal(); data.GetPolys()->GetNextCell(size, corners);) {
        if (size != 3) continue;
        Triangle t;
        for (int c = 0; c < 3; ++c) t[c] = static_cast<Index>(corners[c]);
        const Vec3 a = points[t[1]] - points[t[0]], b = points[t[2]] - points[t[0]];
        if (a.cross(b).norm() > 1e-9 * (a.squaredNorm() + b.squaredNorm())) triangles.push_back(t);
    }
    return triangles;
}

}  // namespace

std::vector<Vec3> read_points(const fs::path& path, Frame frame) {
    if (const auto why = why_unreadable(path)) unreadable(path, *why);
    const std::string ending = ending_of(path);
    const bool is_text = ending == ".csv" || ending == ".txt" || ending == ".xyz";
    std::vector<Vec3> points;
    if (is_text) {
        points = read_text(path);
    } else if (const PolyData data = read_polydata(path, ending)) {
        points = points_of(*data);
    } else {
        unreadable(path, "points come from .csv, .txt, .xyz, .vtp, .vtk or .ply");
    }
    check_finite(points, path);
    if (points.size() < least_read_points) {
        unusable(path, fmt::format("it holds {} points, at least {} are needed to see a surface",
                                   points.size(), least_read_points));
    }
    turn_to_lps(points, frame);
    return points;
}

Surface read_surface(const fs::path& path, Frame frame) {
    if (const auto why = why_unreadable(path)) unreadable(path, *why);
    const std::string ending = ending_of(path);
    PolyData data = read_polydata(path, ending);
    if (ending == ".stl") data = read_with<vtkSTLReader>(path);
    if (ending == ".obj") data = read_with<vtkOBJReader>(path);
    if (!data) unreadable(path, "surfaces come from .vtp, .vtk, .ply, .stl or .obj");
    check_finite(points_of(*data), path);
    data = cleaned_triangles(*data);
    Surface surface{points_of(*data), {}};
    surface.triangles = triangles_of(*data, surface.vertices);
    if (surface.triangles.empty()) {
        unusable(path, "it holds no triangles; give points with --target-points");
    }
    turn_to_lps(surface.vertices, frame);
    return surface;
}

}  // namespace palpate

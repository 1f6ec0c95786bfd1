// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/plane_section.hpp"

#include <vtkCellArray.h>
#include <vtkCutter.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStripper.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace palpate {
namespace {

vtkNew<vtkPolyData> poly_data_of(const Surface& surface) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Vec3& vertex : surface.vertices) points->InsertNextPoint(vertex.data());
    vtkNew<vtkCellArray> cells;
    for (const Triangle& triangle : surface.triangles) {
        const vtkIdType corners[3] = {triangle[0], triangle[1], triangle[2]};
        cells->InsertNextCell(3, corners);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    return data;
}

double distance_to_segment(const Vec3& point, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    const double squared = along.squaredNorm();
    const double t = squared > 0 ? std::clamp((point - a).dot(along) / squared, 0.0, 1.0) : 0;
    return (point - a - t * along).norm();
}

}  // namespace

std::vector<SectionLine> plane_section(const Surface& surface, int axis, double at_mm) {
    if (surface.triangles.empty()) return {};
    vtkNew<vtkPlane> plane;
    const Vec3 normal = Vec3::Unit(axis), origin = at_mm * normal;
    plane->SetOrigin(origin[0], origin[1], origin[2]);
    plane->SetNormal(normal[0], normal[1], normal[2]);
    vtkNew<vtkCutter> cutter;
    cutter->SetCutFunction(plane);
    cutter->SetOutputPointsPrecision(1);  // double
    const auto data = poly_data_of(surface);
    cutter->SetInputData(data);
    vtkNew<vtkStripper> joined;
    joined->SetInputConnection(cutter->GetOutputPort());
    joined->SetMaximumLength(std::numeric_limits<int>::max() / 2);
    joined->JoinContiguousSegmentsOn();
    joined->Update();
    std::vector<SectionLine> lines;
    vtkPolyData& found = *joined->GetOutput();
    vtkCellArray& cells = *found.GetLines();
    const vtkIdType* ids = nullptr;
    vtkIdType count = 0;
    for (cells.InitTraversal(); cells.GetNextCell(count, ids);) {
        SectionLine line(static_cast<std::size_t>(count));
        for (vtkIdType k = 0; k < count; ++k) found.GetPoint(ids[k], line[std::size_t(k)].data());
        lines.push_back(std::move(line));
    }
    return lines;
}

SectionLine thinned(const SectionLine& line, double tolerance_mm) {
    if (line.size() < 3) return line;
    std::vector<bool> stays(line.size(), false);
    stays.front() = stays.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> parts{{0, line.size() - 1}};
    while (!parts.empty()) {
        const auto [first, last] = parts.back();
        parts.pop_back();
        double most = tolerance_mm;
        std::size_t furthest = first;
        for (std::size_t k = first + 1; k < last; ++k) {
            const double distance = distance_to_segment(line[k], line[first], line[last]);
            if (distance > most) {
                most = distance;
                furthest = k;
            }
        }
        if (furthest == first) continue;
        stays[furthest] = true;
        parts.emplace_back(first, furthest);
        parts.emplace_back(furthest, last);
    }
    SectionLine kept;
    for (std::size_t k = 0; k < line.size(); ++k)
        if (stays[k]) kept.push_back(line[k]);
    return kept;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/vtk_cells.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>

namespace palpate {

std::optional<std::string> why_unsafe(vtkCellArray& cells, vtkIdType num_points) {
    vtkDataArray& offsets = *cells.GetOffsetsArray();
    vtkDataArray& connectivity = *cells.GetConnectivityArray();
    const auto num_corners = static_cast<double>(connectivity.GetNumberOfTuples());
    double before = 0;
    for (vtkIdType k = 0; k < offsets.GetNumberOfTuples(); ++k) {
        const double offset = offsets.GetComponent(k, 0);
        if (!(offset >= before && offset <= num_corners))
            return fmt::format("the corners of its cell {} lie outside the list of corners", k);
        before = offset;
    }
    for (vtkIdType k = 0; k < connectivity.GetNumberOfTuples(); ++k) {
        const double point = connectivity.GetComponent(k, 0);
        if (!(point >= 0 && point < static_cast<double>(num_points)))
            return fmt::format("a cell has the point {:.0f} of {}", point, num_points);
    }
    return std::nullopt;
}

}  // namespace palpate

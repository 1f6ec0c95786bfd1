// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkType.h>

#include <optional>
#include <string>

class vtkCellArray;

namespace palpate {

/// Why cells as a file gave them cannot be walked through, which VTK's readers do not all check: an
/// offset outside the connectivity, a point beyond `num_points`. Nothing if they can.
std::optional<std::string> why_unsafe(vtkCellArray& cells, vtkIdType num_points);

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Lines of three numbers x y z, divided by commas, semicolons or blanks; one header line, empty
/// lines and lines that begin with # are skipped.
/// Throws Error(input_unreadable) naming the line that is anything else, not the file.
std::vector<Vec3> points_of_text(std::istream& text);

}  // namespace palpate

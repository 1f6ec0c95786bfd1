// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/warping/displacement_field.hpp"

namespace palpate {

/// What the numbers of a point file mean; NIfTI and Slicer's memory are RAS, ITK and palpate LPS.
enum class PointAxes { lps, ras };

/// Points in a comma-separated file, with whatever else its columns hold.
struct PointTable {
    std::vector<std::string> comments;               ///< leading lines that start with '#'
    std::optional<std::vector<std::string>> header;  ///< names of the columns
    std::vector<std::vector<std::string>> rows;      ///< cells as they are in the file
    std::array<std::size_t, 3> columns{0, 1, 2};     ///< of x, y, z
    std::vector<Vec3> points;                        ///< [rows] LPS mm
};

/// Reads a CSV file: a header is there if the first row has no three numbers in front; it must name
/// columns x, y, z (or x_mm, y_mm, z_mm), in any order and case. Without one the first three
/// columns are taken. Cells in double quotes may hold commas.
/// Throws Error(input_unreadable), Error(input_unusable) naming the row: too few cells, no number,
/// no point at all.
PointTable read_points(const std::filesystem::path& path, PointAxes axes);

/// The table with the moved points in the place of the old ones, and a column `inside`: 0 for
/// points beyond the field, which were moved by its border's value. A column of that name that is
/// there already stays 0 where it was 0.
std::string points_csv(const PointTable& table, const std::vector<MovedPoint>& moved,
                       PointAxes axes);

}  // namespace palpate

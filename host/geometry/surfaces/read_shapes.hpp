// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

/// Which way the axes of the coordinates in a file point; palpate itself is LPS.
enum class Frame {
    lps,  ///< left, posterior, superior
    ras,  ///< right, anterior, superior
};

/// Points from text (.csv .txt .xyz: three columns x y z divided by commas, semicolons or blanks;
/// one header line and lines that begin with # are skipped) or from the points of .vtp .vtk .ply,
/// mm. Returns mm LPS. Throws Error(input_unreadable) for a file that is missing, damaged or of
/// another kind, Error(input_unusable) for a point that is not finite or fewer than 8 points.
std::vector<Vec3> read_points(const std::filesystem::path& path, Frame frame = Frame::lps);

/// The triangles of .vtp .vtk .ply .stl .obj, mm; polygons and strips are cut into triangles,
/// coincident points merged. Returns mm LPS, turned as in the file. Throws what `read_points`
/// throws, and Error(input_unusable) for a file without triangles.
Surface read_surface(const std::filesystem::path& path, Frame frame = Frame::lps);

}  // namespace palpate

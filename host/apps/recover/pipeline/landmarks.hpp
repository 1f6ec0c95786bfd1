// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/apps/recover/result/landmark.hpp"
#include "host/geometry/warping/point_table.hpp"
#include "host/io/image.hpp"

namespace palpate {

/// Row by row of two CSV files as `read_points` reads them. Where both have a column `name` or
/// `label`, the rows must carry the same names. Throws what `read_points` throws, and
/// Error(input_unusable) for files of different lengths or names.
std::vector<Landmark> read_landmarks(const std::filesystem::path& reference,
                                     const std::filesystem::path& target, PointAxes axes);

/// `field`: on the reference's grid, reference to target with the alignment in it.
std::vector<LandmarkResult> measure_landmarks(const std::vector<Landmark>& landmarks,
                                              const Image<Vec3>& field,
                                              const RigidTransform& reference_to_target);

}  // namespace palpate

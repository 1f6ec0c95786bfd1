// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/apps/recover/modelling/settings.hpp"
#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/surfaces/distance_map.hpp"

namespace palpate {

enum class AlignMethod { automatic, fixed, centroid, none, transform };
/// Of "auto", "fixed", "centroid", "none". Throws Error(invalid_argument) naming them.
AlignMethod align_method_of(const std::string& name);

/// A surface point that the target was aligned by.
struct AlignedPoint {
    Vec3 place = Vec3::Zero();  ///< in the reference, LPS mm
    Vec3 normal = Vec3::Zero();
    Index surface = 0;  ///< points of different surfaces have independent noise
};

struct AlignmentResult {
    std::string method;  ///< "fixed", "centroid", "none", "transform"
    RigidTransform reference_to_target;
    double mean_distance_mm = 0;            ///< of the fixed surfaces after it, if any
    std::vector<AlignedPoint> points = {};  ///< of those surfaces, with the target's normals
    /// By which the search moved it, within what these points leave open.
    double moved_mm = 0, turned_deg = 0;
};

/// Centroids of the organs that are not fixed: takes the reference centroid to the target's.
RigidTransform align_centroids(const RegionImage& reference, const RegionImage& target,
                               const Settings& settings);

/// Rigid motion that brings the fixed organs' reference surfaces onto the target's, by Gauss-Newton
/// on the signed distances, from `start`. `points` are surface points of the fixed organs (LPS mm),
/// one list per map. Throws Error(input_unusable) if the surfaces end more than 5 mm apart.
AlignmentResult align_surfaces(const std::vector<std::vector<Vec3>>& points,
                               const std::vector<DistanceMap>& target_maps,
                               const RigidTransform& start);

}  // namespace palpate

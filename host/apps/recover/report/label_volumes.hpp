// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// The three label volumes as the report shows them, on the target's grid and in its frame (without
/// target labels: on the reference's, moved there): cropped to the organs with a margin, axes
/// reordered and turned so that index 0, 1, 2 run as nearly as the grid allows to the patient's
/// left, back and head (+x, +y, +z in LPS). Voxel value: 0 or 1 + position in `regions`.
struct LabelVolumes {
    std::array<Index, 3> size{0, 0, 0};
    Vec3 spacing = Vec3::Ones();   ///< mm
    Vec3 origin = Vec3::Zero();    ///< LPS mm of the centre of voxel (0, 0, 0)
    Mat3 axes = Mat3::Identity();  ///< columns: unit vectors of the three axes, LPS
    double tilt_deg = 0;           ///< largest angle between a grid and a patient axis
    std::vector<Index> regions;    ///< organs in order, region numbers
    std::vector<std::uint8_t> reference, target, warped;  ///< index 0 fastest
    std::array<Index, 3> centre{0, 0, 0};  ///< where the first slices lie: in the unknown organs

    bool empty() const { return reference.empty(); }
    std::size_t offset(Index i, Index j, Index k) const {
        return std::size_t(i) + std::size_t(size[0]) * (std::size_t(j) + std::size_t(size[1]) * k);
    }
};

inline constexpr std::size_t most_shown_voxels = 24'000'000;

/// Empty if no organ has a voxel. A volume of more than `max_voxels` is thinned out by whole steps.
LabelVolumes label_volumes(const RecoveryResult& result, std::size_t max_voxels = most_shown_voxels,
                           double margin_mm = 8);

}  // namespace palpate

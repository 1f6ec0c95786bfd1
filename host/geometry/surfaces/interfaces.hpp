// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/fields/label_field.hpp"

namespace palpate {

/// The interfaces of a `LabelField` seen in the image's own frame (axes along i, j, k, mm, origin
/// at the corner of the first voxel), each region grown by its own offset: between regions a and b
/// the interface is where value_a - offset_a = value_b - offset_b. Offsets make volumes come out
/// right while surfaces stay smooth and still meet in common curves.
class Interfaces {
public:
    Interfaces(const LabelField& field, const ImageGrid& grid);

    Vec3 to_lps(const Vec3& point) const { return corner_ + direction_ * point; }

    double value(Index region, const Vec3& point) const {
        return field_.value(region, to_lps(point)) - offsets_[region];
    }
    double value(Index region, const Vec3& point, Vec3& gradient) const;

    /// A damped Newton step from `point` towards the place where all `regions` meet (two: a
    /// surface, three: a curve, four: a point); zero for one region. Along the axes marked in
    /// `fixed_axes` (bit 0: i ...) the point does not move. No longer than `max_step_mm`.
    Vec3 step_to_interface(const Vec3& point, std::span<const std::uint8_t> regions,
                           unsigned fixed_axes, double max_step_mm) const;

    std::vector<double>& offsets() { return offsets_; }  ///< mm, [num_regions]

private:
    const LabelField& field_;
    Mat3 direction_;
    Vec3 corner_;
    std::vector<double> offsets_;
};

}  // namespace palpate

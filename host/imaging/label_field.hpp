// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/imaging/label_image.hpp"

namespace palpate {

/// Smooth sub-voxel description of a region image: one smoothed signed distance per region (mm,
/// negative inside), so that the region at a point is the one with the smallest value and
/// interfaces are smooth surfaces. Regions that are absent have an empty field.
///
/// Built from the unbiased signed distance of each binary mask, (outer - inner)/2 corrected for the
/// half voxel between centres, smoothed by a Gaussian, sampled on the voxel grid, and interpolated
/// by cubic B-splines. Beyond the image the border slices continue outward: an organ that the field
/// of view cuts keeps running straight, so that its surface has no false end.
class LabelField {
public:
    /// `smoothing_mm` is the Gaussian standard deviation; 0 chooses 0.9 x the geometric mean spacing.
    LabelField(const RegionImage& image, Index num_regions, double smoothing_mm = 0);

    const ImageGrid& grid() const { return grid_; }
    Index num_regions() const { return static_cast<Index>(coefficients_.size()); }
    bool has_region(Index region) const { return !coefficients_[region].empty(); }
    double smoothing_mm() const { return smoothing_mm_; }

    /// Smoothed signed distance of one region at a point (LPS mm); large and positive if absent.
    double value(Index region, const Vec3& point) const;
    /// The same with its gradient (LPS, per mm).
    double value(Index region, const Vec3& point, Vec3& gradient) const;
    /// Signed distance towards the interface between two regions: (value_a - value_b) / 2.
    double interface_value(Index a, Index b, const Vec3& point, Vec3* gradient = nullptr) const;
    /// The region with the smallest value.
    Index region_at(const Vec3& point) const;
    /// Whether the point lies inside the image box (voxel edges, not centres).
    bool inside_box(const Vec3& point) const;

private:
    ImageGrid grid_;
    ImageGrid padded_;   ///< grid of the coefficients: `grid_` and a few voxels all round
    double smoothing_mm_ = 0;
    std::vector<std::vector<float>> coefficients_;  ///< per region, cubic B-spline coefficients
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "host/io/label_image.hpp"

namespace palpate {

/// Smooth sub-voxel description of a region image: one smoothed signed distance per region (mm,
/// negative inside), so that the region at a point is the one with the smallest value and
/// interfaces are smooth surfaces. Regions that are absent have an empty field.
///
/// Built from the signed distance of each mask to the surface of its voxels taken as boxes (the
/// same for a mask and its complement, hence unbiased), smoothed by a Gaussian with its shrinkage
/// taken out (`smooth_without_shrinking`), sampled on the voxel grid, and interpolated by cubic
/// B-splines. Beyond the image the border slices continue outward: an organ that the field of view
/// cuts keeps running straight, so that its surface has no false end. Memory: 4 bytes per voxel of
/// each region's box with 10 mm around, and one per voxel of the image. Const calls are thread
/// safe.
class LabelField {
public:
    /// `smoothing_mm` is the Gaussian standard deviation; 0 chooses 0.9 x the geometric mean
    /// spacing. Throws Error(invalid_argument) for an empty image or a region number >=
    /// num_regions.
    LabelField(const RegionImage& image, Index num_regions, double smoothing_mm = 0);

    const ImageGrid& grid() const { return grid_; }
    Index num_regions() const { return static_cast<Index>(coefficients_.size()); }
    bool has_region(Index region) const { return !coefficients_[region].empty(); }
    double smoothing_mm() const { return smoothing_mm_; }

    /// Smoothed signed distance of one region at a point (LPS mm); large and positive if absent.
    double value(Index region, const Vec3& point) const;
    /// A number that `value` is not below, found without evaluating it: for searches among regions.
    /// Infinite if the region is absent.
    double lower_bound(Index region, const Vec3& point) const;
    /// The same as `value` with its gradient (LPS, per mm).
    double value(Index region, const Vec3& point, Vec3& gradient) const;
    /// Signed distance towards the interface between two regions: (value_a - value_b) / 2.
    double interface_value(Index a, Index b, const Vec3& point, Vec3* gradient = nullptr) const;
    /// The region with the smallest value but `region`: what that one meets there.
    Index nearest_other(Index region, const Vec3& point) const;
    /// The region with the smallest value.
    Index region_at(const Vec3& point) const;
    /// Whether the point lies inside the image box (voxel edges, not centres).
    bool inside_box(const Vec3& point) const;

    /// Whether the image box cuts the region: it has a voxel in a border slice.
    bool cut_by_image(Index region) const { return has_region(region) && boxes_[region].cut; }
    /// Voxel indices of the first and the last voxel of a region along each axis; it must be there.
    std::array<std::array<Index, 3>, 2> voxel_box(Index region) const {
        return {boxes_[region].first, boxes_[region].last};
    }

private:
    /// Where the coefficients of one region lie. Outside that box the field goes on: unchanged
    /// beyond the padded image, growing by the distance elsewhere.
    struct Box {
        std::array<Index, 3> first{0, 0, 0}, last{-1, -1, -1};  ///< voxels of the region in `grid_`
        bool cut = false;
        std::array<Index, 3> low{0, 0, 0}, size{0, 0, 0};   ///< stored samples in `grid_`
        std::array<std::array<bool, 2>, 3> is_image_end{};  ///< per axis, low and high
    };
    void find_boxes(const RegionImage& image);
    void store_around(Index region, const std::array<Index, 3>& pad);
    void build_region(const RegionImage& image, Index region);
    void find_deep_voxels(const RegionImage& image);
    /// Index in the stored box, clamped to it; `beyond` receives the offset cut off (mm, grid axes)
    /// and `held` which axes were clamped.
    Vec3 clamped_index(const Box& box, const Vec3& point, Vec3& beyond,
                       std::array<bool, 3>& held) const;

    ImageGrid grid_;
    double smoothing_mm_ = 0;
    std::vector<Box> boxes_;
    std::vector<std::vector<float>> coefficients_;  ///< per region, cubic B-spline coefficients
    /// [num_voxels] the region where the voxels around leave no other one, else `near_interface`.
    std::vector<std::uint8_t> deep_;
};

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/distance_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "host/geometry/fields/cubic_bspline.hpp"
#include "host/geometry/fields/gaussian_smoothing.hpp"
#include "host/geometry/surfaces/closest_point.hpp"
#include "host/geometry/surfaces/nearest_triangles.hpp"
#include "host/geometry/surfaces/zero_level.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr double max_samples = 4e6;
constexpr double exact_reach_mm = 4;  ///< beyond it a tenth of a millimetre does not matter

/// Signed distance (mm, near the surface) to a region's boundary. A region's field is blunt where
/// the region is thin (0.04 to 0.08 mm at two to four voxels, from what takes out the shrinkage),
/// so that the region's own is used where the region is thick, whatever lies beyond: against half
/// of what is left of its neighbour's, organs seem to shrink where a wall comes near. Where the
/// region is thin, the mean of both errs less.
class RegionLevel {
public:
    RegionLevel(const LabelField& field, Index region)
        : field_(field), region_(region), depth_mm_(depth_smoothings * field.smoothing_mm()) {}

    double value(const Vec3& x) const {
        Vec3 gradient;
        return value(x, gradient);
    }
    double value(const Vec3& x, Vec3& gradient) const {
        const double own = field_.value(region_, x, gradient);
        const double share = 0.5 * thinness(x, own, gradient);
        if (share == 0) return own;
        Vec3 beyond_gradient;
        const double beyond = field_.value(field_.nearest_other(region_, x), x, beyond_gradient);
        gradient = (1 - share) * gradient - share * beyond_gradient;
        return (1 - share) * own - share * beyond;
    }
    /// As `value` near the surface; farther than `band_mm` only its sign is right (and cheap).
    double value_in_band(const Vec3& x, double band_mm) const {
        const double own = field_.value(region_, x);
        return std::abs(own) > band_mm ? own : value(x);
    }

private:
    static constexpr double depth_smoothings = 2.5;
    static constexpr double thick_slope = 0.85, thin_slope = 0.35;

    /// 0 where the field still falls at `depth_mm_` inside, 1 where it has come to its ridge.
    double thinness(const Vec3& x, double own, const Vec3& gradient) const {
        const double slope = gradient.norm();
        if (!(slope > 0)) return 1;
        const Vec3 outward = gradient / slope;
        Vec3 inside_gradient;
        field_.value(region_, x - (depth_mm_ + own) * outward, inside_gradient);
        const double falls = inside_gradient.dot(outward);
        return std::clamp((thick_slope - falls) / (thick_slope - thin_slope), 0.0, 1.0);
    }

    const LabelField& field_;
    Index region_;
    double depth_mm_;
};

/// A grid of spacing h along the axes of `along` that covers the given range of its voxel indices.
ImageGrid grid_over(const ImageGrid& along, const Vec3& low, const Vec3& high, double h) {
    ImageGrid grid;
    grid.direction = along.direction;
    grid.origin = along.to_point(low);
    grid.spacing = Vec3::Constant(h);
    for (int a = 0; a < 3; ++a) {
        grid.size[a] = std::max(
            4, static_cast<Index>(std::ceil((high[a] - low[a]) * along.spacing[a] / h)) + 1);
    }
    return grid;
}

/// Range of voxel indices `margin_mm` round the region's voxels.
struct Range {
    Vec3 low, high;
};
Range range_around(const LabelField& field, Index region, double margin_mm) {
    const auto [first, last] = field.voxel_box(region);
    const Vec3 margin = Vec3::Constant(margin_mm).cwiseQuotient(field.grid().spacing);
    return {Vec3(first[0] - 0.5, first[1] - 0.5, first[2] - 0.5) - margin,
            Vec3(last[0] + 0.5, last[1] + 0.5, last[2] + 0.5) + margin};
}

ImageGrid sample_grid(const LabelField& field, Index region, double margin_mm) {
    const Range range = range_around(field, region, margin_mm);
    double h = std::min(1.0, std::cbrt(field.grid().voxel_volume()));
    ImageGrid grid = grid_over(field.grid(), range.low, range.high, h);
    const double excess = double(grid.num_voxels()) / max_samples;
    if (excess > 1) grid = grid_over(field.grid(), range.low, range.high, h * std::cbrt(excess));
    return grid;
}

/// The level at every sample of the grid that can be near the surface; elsewhere its sign.
std::vector<float> sample_level(const LabelField& field, Index region, const RegionLevel& level,
                                const ImageGrid& grid) {
    const double h = grid.spacing[0];
    const double band = 2 * field.grid().spacing.maxCoeff() + 2 * h;
    const auto [first, last] = field.voxel_box(region);
    Range near = range_around(field, region, field.grid().spacing.maxCoeff() + 3 * h);
    for (int a = 0; a < 3;
         ++a) {  // where the image cuts the region, its surface goes on to the end
        if (first[a] == 0) near.low[a] = -1e9;
        if (last[a] == field.grid().size[a] - 1) near.high[a] = 1e9;
    }
    std::vector<float> samples(grid.num_voxels());
    parallel_ranges(grid.size[2], 1, [&](std::size_t begin, std::size_t end) {
        for (Index k = Index(begin); k < Index(end); ++k) {
            for (Index j = 0; j < grid.size[1]; ++j) {
                for (Index i = 0; i < grid.size[0]; ++i) {
                    const Vec3 x = grid.to_point(Vec3(i, j, k));
                    const Vec3 voxel = field.grid().to_index(x);
                    const bool is_near = (voxel.array() >= near.low.array()).all() &&
                                         (voxel.array() <= near.high.array()).all();
                    samples[grid.offset(i, j, k)] =
                        is_near ? static_cast<float>(level.value_in_band(x, band)) : 1e3f;
                }
            }
        }
    });
    return samples;
}

/// Triangles cut the corners of a curved surface: adds what is left of the level at the closest
/// point (a step of Newton's method), near the surface, where it matters.
void correct_for_facets(const Surface& surface, const RegionLevel& level, const ImageGrid& grid,
                        const NearestTriangles& nearest, std::vector<float>& distances) {
    const double most = 0.3 * grid.spacing[0];
    parallel_ranges(grid.size[2], 1, [&](std::size_t begin, std::size_t end) {
        for (Index k = Index(begin); k < Index(end); ++k) {
            for (Index j = 0; j < grid.size[1]; ++j) {
                for (Index i = 0; i < grid.size[0]; ++i) {
                    const std::size_t n = grid.offset(i, j, k);
                    if (nearest.distance[n] > exact_reach_mm) continue;
                    const Triangle& t = surface.triangles[nearest.triangle[n]];
                    const Vec3 closest = closest_point_of_triangle(
                        grid.to_point(Vec3(i, j, k)), surface.vertices[t[0]],
                        surface.vertices[t[1]], surface.vertices[t[2]]);
                    Vec3 gradient;
                    const double rest = level.value(closest, gradient);
                    const double slope = std::max(0.3, gradient.norm());
                    distances[n] += static_cast<float>(std::clamp(rest / slope, -most, most));
                }
            }
        }
    });
}

/// Replaces each sample of the level by the signed distance to its zero.
void replace_by_distance(const Surface& surface, const RegionLevel& level, const ImageGrid& grid,
                         std::vector<float>& samples) {
    const NearestTriangles nearest = nearest_triangles(surface, grid, exact_reach_mm);
    for (std::size_t n = 0; n < samples.size(); ++n) {
        samples[n] = std::copysign(nearest.distance[n], samples[n]);
    }
    correct_for_facets(surface, level, grid, nearest, samples);
}

}  // namespace

DistanceMap::DistanceMap(const LabelField& field, Index region, double margin_mm) {
    if (region < 0 || region >= field.num_regions() || !field.has_region(region)) {
        throw Error(ErrorCode::input_unusable,
                    "region " + std::to_string(region) + " has no voxels, so it has no surface");
    }
    grid_ = sample_grid(field, region, margin_mm);
    const RegionLevel level(field, region);
    coefficients_ = sample_level(field, region, level, grid_);
    const Surface surface =
        zero_level(grid_, coefficients_, [&](const Vec3& x) { return level.value(x); });
    if (surface.triangles.empty()) {
        throw Error(ErrorCode::input_unusable,
                    "region " + std::to_string(region) +
                        " has no surface: it is too small for its voxels or fills the image");
    }
    replace_by_distance(surface, level, grid_, coefficients_);
    to_bspline_coefficients(grid_.size, coefficients_);
    smooth_ = coefficients_;
    smooth_gaussian(grid_.size, normal_smoothing_mm / grid_.spacing[0], smooth_);
}

double DistanceMap::value(const Vec3& point) const {
    const Vec3 index = grid_.to_index(point);
    const Vec3 clamped = clamped_to_support(grid_.size, index);
    if (index == clamped) return bspline_value(grid_.size, coefficients_.data(), clamped);
    Vec3 slope;
    const double value = bspline_value(grid_.size, coefficients_.data(), clamped, &slope);
    return value + slope.dot(index - clamped);
}

double DistanceMap::value(const Vec3& point, Vec3& gradient) const {
    return value_of(coefficients_, point, gradient);
}

double DistanceMap::value_of(const std::vector<float>& coefficients, const Vec3& point,
                             Vec3& gradient) const {
    const Vec3 index = grid_.to_index(point);
    const Vec3 clamped = clamped_to_support(grid_.size, index);
    const Vec3 beyond = index - clamped;
    Vec3 slope;
    double value = bspline_value(grid_.size, coefficients.data(), clamped, &slope);
    if (index != clamped) {
        // The slope that continues the map outward changes along the border.
        value += slope.dot(beyond);
        for (int free = 0; free < 3; ++free) {
            for (int held = 0; held < 3; ++held) {
                if (beyond[free] != 0 || beyond[held] == 0) continue;
                std::array<int, 3> orders{0, 0, 0};
                orders[free] = orders[held] = 1;
                slope[free] += beyond[held] *
                               bspline_derivative(grid_.size, coefficients.data(), clamped, orders);
            }
        }
    }
    gradient = grid_.direction * slope.cwiseQuotient(grid_.spacing);
    return value;
}

ShapeDistance DistanceMap::measure(const Vec3& point, const Vec3&) const {
    ShapeDistance result;
    result.mm = value(point, result.normal);
    value_of(smooth_, point, result.smooth_normal);
    result.smooth_normal.normalize();
    return result;
}

DistanceMap DistanceMap::moved(const RigidTransform& transform) const {
    DistanceMap result = *this;
    result.grid_.origin = transform.apply(grid_.origin);
    result.grid_.direction = transform.rotation * grid_.direction;
    return result;
}

}  // namespace palpate

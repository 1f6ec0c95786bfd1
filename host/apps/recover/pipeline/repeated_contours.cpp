// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/repeated_contours.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/apps/recover/pipeline/target_state.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct SquareSum {
    double mm2 = 0;
    long count = 0;
};

/// Of the distances to `second` of the points of `first`'s surface that voxels are nearest to.
SquareSum squares_between(const DistanceMap& first, const DistanceMap& second,
                          const ImageGrid& grid) {
    const double near = 0.5 * grid.spacing.maxCoeff();
    SquareSum sum;
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i) {
                const Vec3 point = grid.to_point(Vec3(i, j, k));
                Vec3 normal;
                const double distance = first.value(point, normal);
                if (std::abs(distance) > near) continue;
                sum.mm2 += std::pow(second.value(point - distance * normal), 2);
                ++sum.count;
            }
    return sum;
}

}  // namespace

double contour_sd_of(const Segmentation& first, const Segmentation& second,
                     const Settings& settings) {
    if (!first.labels.grid.is_like(second.labels.grid))
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{} and {} lie on different grids; a repeated segmentation must be "
                                "of the same image",
                                first.name, second.name));
    if (is_same(first, second))
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{} and {} have the same labels, which tells nothing about "
                                "contours; segment the image once more, independently",
                                first.name, second.name));
    const LabelledState a = make_state(first, settings), b = make_state(second, settings);
    const std::vector<DistanceMap> maps_a = maps_of_matched(a.field, settings, target_margin_mm);
    const std::vector<DistanceMap> maps_b = maps_of_matched(b.field, settings, target_margin_mm);
    SquareSum all;
    for (std::size_t organ = 0; organ < maps_a.size(); ++organ) {
        const SquareSum own = squares_between(maps_a[organ], maps_b[organ], a.regions.grid);
        all.mm2 += own.mm2;
        all.count += own.count;
    }
    if (all.count == 0) return 0;
    const double voxels = settings.prior.noise_voxels * a.regions.grid.spacing.mean();
    const double sd_mm =
        std::sqrt(std::max(0.0, 0.5 * all.mm2 / double(all.count) - voxels * voxels));
    if (sd_mm > largest_contour_sd_mm)
        throw Error(
            ErrorCode::input_unusable,
            fmt::format("the contours of {} and {} are off by {:.1f} mm each, more than the "
                        "{:g} mm that palpate can compute with; are they of one image?",
                        first.name, second.name, sd_mm, largest_contour_sd_mm));
    return sd_mm;
}

}  // namespace palpate

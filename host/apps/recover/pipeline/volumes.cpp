// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/volumes.hpp"

#include <algorithm>

#include "host/apps/recover/modelling/regions.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

/// Regions of the reference at the points origin(y, voxel) for each voxel centre y of `grid`.
template <typename Origin>
RegionImage regions_at(const LabelField& reference, const ImageGrid& grid, const Origin& origin) {
    RegionImage carried{grid, std::vector<std::uint8_t>(grid.num_voxels())};
    parallel_ranges(grid.size[1] * grid.size[2], 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const Index j = static_cast<Index>(row) % grid.size[1];
            const Index k = static_cast<Index>(row) / grid.size[1];
            for (Index i = 0; i < grid.size[0]; ++i) {
                const std::size_t at = grid.offset(i, j, k);
                const Vec3 x = origin(grid.to_point(Vec3(i, j, k)), at);
                carried.voxels[at] = static_cast<std::uint8_t>(reference.region_at(x));
            }
        }
    });
    return carried;
}

}  // namespace

RegionImage carry_regions(const LabelField& reference, const RigidTransform& reference_to_target,
                          const ImageGrid& target_grid) {
    const RigidTransform back = reference_to_target.inverse();
    return regions_at(reference, target_grid,
                      [&](const Vec3& y, std::size_t) { return back.apply(y); });
}

RegionImage carry_regions(const LabelField& reference, const Image<Vec3>& target_to_reference) {
    return regions_at(reference, target_to_reference.grid, [&](const Vec3& y, std::size_t voxel) {
        return Vec3(y + target_to_reference.voxels[voxel]);
    });
}

LabelImage to_labels(const RegionImage& regions, const Settings& settings) {
    LabelImage labels{regions.grid, std::vector<std::uint16_t>(regions.voxels.size())};
    std::vector<std::uint16_t> table(256, 0);
    for (Index r = 0; r < settings.num_regions(); ++r) {
        table[r] = static_cast<std::uint16_t>(label_of_region(settings, r));
    }
    std::transform(regions.voxels.begin(), regions.voxels.end(), labels.voxels.begin(),
                   [&](std::uint8_t region) { return table[region]; });
    return labels;
}

double dice(const RegionImage& a, const RegionImage& b, Index region) {
    double both = 0, sum = 0;
    for (std::size_t v = 0; v < a.voxels.size(); ++v) {
        const bool in_a = a.voxels[v] == region;
        const bool in_b = b.voxels[v] == region;
        both += in_a && in_b;
        sum += in_a + in_b;
    }
    return sum > 0 ? 2.0 * both / sum : 0.0;
}

Image<Vec3> with_alignment(const Image<Vec3>& displacement, const RigidTransform& transform) {
    Image<Vec3> total = displacement;
    for (Index k = 0; k < total.grid.size[2]; ++k) {
        for (Index j = 0; j < total.grid.size[1]; ++j) {
            for (Index i = 0; i < total.grid.size[0]; ++i) {
                const Vec3 x = total.grid.to_point(Vec3(i, j, k));
                total.at(i, j, k) = transform.apply(x + displacement.at(i, j, k)) - x;
            }
        }
    }
    return total;
}

}  // namespace palpate

// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/pipeline/volumes.hpp"

#include <algorithm>
#include <cmath>

#include "host/imaging/parallel.hpp"
#include "host/modelling/regions.hpp"

namespace palpate {
namespace {

/// Trilinear, the border value beyond the grid.
Vec3 sample(const Image<Vec3>& image, const Vec3& point) {
    const Vec3 index = image.grid.to_index(point);
    std::array<Index, 3> low;
    Vec3 t;
    for (int a = 0; a < 3; ++a) {
        const double last = image.grid.size[a] - 1;
        const double x = std::clamp(index[a], 0.0, last);
        low[a] = std::min(static_cast<Index>(x), std::max<Index>(0, image.grid.size[a] - 2));
        t[a] = x - low[a];
    }
    Vec3 sum = Vec3::Zero();
    for (int corner = 0; corner < 8; ++corner) {
        std::array<Index, 3> at;
        double weight = 1;
        for (int a = 0; a < 3; ++a) {
            const bool upper = corner >> a & 1;
            at[a] = std::min<Index>(low[a] + upper, image.grid.size[a] - 1);
            weight *= upper ? t[a] : 1 - t[a];
        }
        if (weight > 0) sum += weight * image.at(at[0], at[1], at[2]);
    }
    return sum;
}

/// x with x + u(x) = y: fixed-point iteration, which contracts while |grad u| < 1.
Vec3 pulled_back(const Image<Vec3>& displacement, const Vec3& y) {
    constexpr int most_iterations = 30;
    constexpr double close_enough_mm = 0.01;
    Vec3 x = y;
    for (int k = 0; k < most_iterations; ++k) {
        const Vec3 next = y - sample(displacement, x);
        const double change = (next - x).norm();
        x = k < 10 ? next : Vec3(0.5 * (next + x));  // damped where it does not contract
        if (change < close_enough_mm) break;
    }
    return x;
}

template <typename Function>
void for_each_slice(Index slices, const Function& function) {
    parallel_for(static_cast<std::size_t>(slices), [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) function(static_cast<Index>(k));
    });
}

}  // namespace

RegionImage carry_regions(const LabelField& reference, const Image<Vec3>& displacement,
                          const RigidTransform& reference_to_target, const ImageGrid& target_grid) {
    RegionImage carried{target_grid, std::vector<std::uint8_t>(target_grid.num_voxels())};
    const RigidTransform back = reference_to_target.inverse();
    for_each_slice(target_grid.size[2], [&](Index k) {
        for (Index j = 0; j < target_grid.size[1]; ++j) {
            for (Index i = 0; i < target_grid.size[0]; ++i) {
                const Vec3 y = back.apply(target_grid.to_point(Vec3(i, j, k)));
                const Vec3 x = displacement.voxels.empty() ? y : pulled_back(displacement, y);
                carried.at(i, j, k) = static_cast<std::uint8_t>(reference.region_at(x));
            }
        }
    });
    return carried;
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

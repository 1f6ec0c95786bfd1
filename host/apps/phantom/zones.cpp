// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/zones.hpp"

#include "solver/base/parallel.hpp"

namespace palpate {

OrganShape make_transition_zone(const OrganShape& prostate, unsigned seed) {
    RandomNumbers random(0x7a6f6e65ull * 1000003ull + seed);
    OrganShape zone;
    zone.axes = prostate.axes;
    // Far enough in front that both surfaces meet at an angle of 30 degrees or more.
    const Vec3 place(random.uniform(-0.05, 0.05), random.uniform(-0.64, -0.56),
                     random.uniform(0.0, 0.12));
    zone.centre = prostate.centre + prostate.axes * place.cwiseProduct(prostate.semi_axes);
    const Vec3 size(random.uniform(0.76, 0.86), random.uniform(0.76, 0.88),
                    random.uniform(0.74, 0.84));
    zone.semi_axes = size.cwiseProduct(prostate.semi_axes);
    zone.warp_mm = random.uniform(0.8, 1.6);
    for (SmoothField& field : zone.warp) field = SmoothField(random, 24, 45);
    return zone;
}

void mark_zone(RegionImage& image, const OrganShape& zone, Index whole, Index part) {
    const auto& size = image.grid.size;
    parallel_ranges(size[2], 1, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k)
            for (Index j = 0; j < size[1]; ++j)
                for (Index i = 0; i < size[0]; ++i) {
                    auto& voxel = image.at(i, j, k);
                    if (voxel != whole || zone.value(image.grid.to_point(Vec3(i, j, k))) >= 0)
                        continue;
                    voxel = static_cast<std::uint8_t>(part);
                }
    });
}

}  // namespace palpate
